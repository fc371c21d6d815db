#!/usr/bin/env bash
# A released network, trained further on your own hair: import, simulate and train, then compare under a motion that the
# training did not see. Two minutes on two cores for a thousand strands, and as long as the comparison takes.
#
#   fine_tune.sh HAIR [FOLDER]            HAIR: .hair .data .bin .ply .tfx; FOLDER: what is made (default: out)
#
# Variables: UNITS=m|cm|mm|auto and UP=y|z of the file (auto, y); GRID of roots, which bounds the strands ([32, 32]);
# NETWORK (displayed_m); FRAMES of the comparison (48) and EPOCHS (6). The program `wetcurl` is that of the path.
set -euo pipefail
[[ $# -ge 1 && $1 != -* ]] || { sed -n '2,/^[^#]/s/^# \{0,1\}//p' "$0"; exit 2; }
hair=$(realpath "$1")
network=models/weights/${NETWORK:-displayed_m}.h5
mkdir -p "${2:-out}"
cd "${2:-out}"

# Metres, Y up. The report says how the strands lie on a grid of roots, and what was left out.
wetcurl import "$hair" hair.data --units "${UNITS:-auto}" --up "${UP:-y}" --overwrite

# Curls that water wets and clumps, on a head that turns. With a head mesh: scalp = "head.obj" in [groom], and a [[solid]]
# of shape "mesh".
cat >scene.toml <<TOML
title = "My hair"
frames = ${FRAMES:-48}
fps = 24
[groom]
file = "hair.data"
units = "m"
grid = ${GRID:-[32, 32]}
particles = 64
[motion]
axis = [0.2, 1, 0.1]
angle = 25
period = 1.6
[integrator]
substeps = 10
settle = 1.5
[fibre]
[stiffness]
dry = 4.0
wet = 4.0
[wetness]
[curl]
[cohesion]
TOML

# A network that an earlier run left would be kept as it is.
rm -rf tuned.h5* own_hair
# The recipe draws motions of the head, simulates each dry with few strands and wet with all, and goes on training.
wetcurl retrain scenes/dataset/tuned.toml --scene scene.toml --from "$network" -o . --set epochs="${EPOCHS:-6}"

# Beside the simulation: both networks, and the best way without one.
wetcurl simulate scene.toml -o wet.h5 --overwrite --json wet.json
strands=$(sed -n 's/^ *"strands": \([0-9]*\).*/\1/p' wet.json)
wetcurl simulate scene.toml --dry --strands $((strands / 2)) --set integrator.substeps=2 -o dry.h5 --overwrite
set -- --wetness scene.toml --overwrite
wetcurl infer dry.h5 "$@" --interpolate rest --wet-shape --cohesion -o no_network_run.h5
wetcurl infer dry.h5 "$@" --model "$network" -o released_run.h5
wetcurl infer dry.h5 "$@" --model tuned.h5 -o tuned_run.h5
wetcurl compare wet.h5 no_network_run.h5 released_run.h5 tuned_run.h5 --first-frame 1 --json compare.json --overwrite
