#!/usr/bin/env bash
# A released network, trained further on your own hair: import, simulate, encode, train, infer, compare.
#
#   fine_tune.sh HAIR [FOLDER]            HAIR: .hair .data .bin .ply .tfx; FOLDER: what is made (default: out)
#
# Variables: UNITS=m|cm|mm|auto and UP=y|z of the file (auto, y); NETWORK (displayed_m); FRAMES (96) and EPOCHS (30).
# The program `wetcurl` is that of the path. The last quarter of the frames is held out; the table is of these.
set -euo pipefail
[[ $# -ge 1 && $1 != -* ]] || { sed -n '2,/^[^#]/s/^# \{0,1\}//p' "$0"; exit 2; }
hair=$(realpath "$1")
network=models/weights/${NETWORK:-displayed_m}.h5
frames=${FRAMES:-96}
mkdir -p "${2:-out}"
cd "${2:-out}"

# Metres, Y up. The report says how the strands lie on a grid of roots, and what was left out.
wetcurl import "$hair" hair.data --units "${UNITS:-auto}" --up "${UP:-y}" --overwrite

# Curls that water wets and clumps, on a head that turns. Released networks learned from 64 particles a strand and 24
# frames a second. With a head mesh: scalp = "head.obj" in [groom], and a [[solid]] of shape "mesh".
cat >scene.toml <<TOML
title = "My hair"
frames = $frames
fps = 24
[groom]
file = "hair.data"
units = "m"
particles = 64
[motion]
axis = [0, 1, 0]
angle = 25
period = 1.6
[integrator]
substeps = 10
settle = 1.5
[stretch]
[bend]
[core]
[wetness]
[curl]
[cohesion]
[stiffness]
dry = 4.0
wet = 4.0
TOML
cat >recipe.toml <<TOML
target = "displayed"  # as the network that it begins with
epochs = ${EPOCHS:-30}
learning_rate = 1e-3
validation = 0.25
validate_every = 5
TOML

# Dry hair of every second root each way (the finest grid of at most half of the strands), and all of it wet.
wetcurl simulate scene.toml -o wet.h5 --overwrite --json wet.json
strands=$(sed -n 's/^ *"strands": \([0-9]*\).*/\1/p' wet.json)
wetcurl simulate scene.toml --dry --strands $((strands / 2)) -o dry.h5 --overwrite
wetcurl encode dry.h5 wet.h5 -o pairs.h5 --overwrite
wetcurl train sr pairs.h5 --from "$network" --recipe recipe.toml -o tuned.h5 --overwrite

# Beside both networks: the best way without one.
wetcurl infer dry.h5 --interpolate rest --wet-shape --cohesion -o no_network_run.h5 --overwrite
wetcurl infer dry.h5 --model "$network" -o released_run.h5 --overwrite
wetcurl infer dry.h5 --model tuned.h5 -o tuned_run.h5 --overwrite
wetcurl compare wet.h5 no_network_run.h5 released_run.h5 tuned_run.h5 --first-frame $((frames - frames / 4)) --json compare.json
