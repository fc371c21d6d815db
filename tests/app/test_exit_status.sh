#!/usr/bin/env bash
# What the program itself adds to its commands: exit statuses, and one line that says why.
# Use: test_exit_status.sh WETCURL SCENE
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/expect.sh"
wetcurl=$1 scene=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

expect 0 '' "'$wetcurl' inspect keys"
expect 1 'standard output: cannot be written' "'$wetcurl' inspect keys >/dev/full"
expect 1 'standard output: cannot be written' "'$wetcurl' inspect keys --json - >/dev/full"
expect 1 'standard output: cannot be written' "'$wetcurl' --help >/dev/full"
# What follows a value is no value more.
expect 0 '' "'$wetcurl' inspect scene --set frames=3 --set seed=4 '$scene'"
expect 2 'found --label 1 times' "'$wetcurl' render --label dry one.h5 two.h5 -o out.png"
expect 2 "did you mean 'simulate'" "'$wetcurl' simulat '$scene'"
expect 2 '--seed: found -1' "'$wetcurl' simulate '$scene' -o run.h5 --seed -1"
expect 2 "--seed: found '99999999999999999999', allowed: a whole number" "'$wetcurl' simulate '$scene' -o run.h5 --seed 99999999999999999999"
expect 2 "--yaw: found 'nan', allowed: a number" "'$wetcurl' render run.h5 -o run.png --yaw nan"
expect 2 "--frames: found 'many', allowed: 1 to 1000000" "'$wetcurl' simulate '$scene' -o run.h5 --frames many"
expect 2 "--frames: found '0', allowed: 1 to 1000000" "'$wetcurl' simulate '$scene' -o run.h5 --frames 0"
expect 2 "--precision: found 'half', allowed: float, double" "'$wetcurl' simulate '$scene' -o run.h5 --precision half"
expect 2 '--method: found' "'$wetcurl' stability --method limb"
expect 2 'reads no scene' "'$wetcurl' stability --set fps=30"
expect 2 'plot reads no scene' "'$wetcurl' plot run.h5 --seed 4 -o out.png"
expect 2 'compare runs on the CPU alone' "'$wetcurl' compare one.h5 two.h5 --device cuda"
expect 2 'nofile.toml: cannot be read' "'$wetcurl' stability nofile.toml --case S1 --quick"
expect 2 'its head still moves after 60 s' "'$wetcurl' stability '$scene' --case S1 --quick"
# A disk that fills up while frames are written, which the library first notices where it closes a data set.
small="--set groom.grid=[4,4] --set integrator.settle=0 --frames 60"
expect 1 'cannot be written (disk full?)' "trap '' XFSZ; ulimit -f 150; '$wetcurl' simulate '$scene' $small -o full.h5 || { rm -f full.h5.partial full.h5.state; exit 1; }"
expect 2 'found an empty folder name' "'$wetcurl' dataset '$(dirname "$scene")/dataset/curls.toml' -o ''"
expect 2 "--relaxation: found 'nan', allowed: 1 to 3.4" "'$wetcurl' infer run.h5 --interpolate quad --cohesion --relaxation nan -o out.h5"
expect 2 "--device: found 'cudafoo'" "'$wetcurl' infer run.h5 --interpolate quad --cohesion --device cudafoo -o out.h5"
expect 2 '--roots' "'$wetcurl' infer run.h5 --interpolate quad -o out.h5 --roots 5"
# Settling takes a minute or two, and nothing is kept of it.
for signal in INT TERM; do
    expect 130 'wetcurl: interrupted' "set -m; '$wetcurl' simulate '$scene' --dry --strands 256 -o run.h5 --set integrator.settle=1000 &
        until [[ -e run.h5.partial ]]; do sleep 0.02; done; kill -$signal \$!; wait \$!"
done
# Of what takes longer, what was measured is kept.
expect 130 'of 4 entries are kept in bench.json.partial' "set -m; '$wetcurl' bench --filter 'level set build' --json bench.json >said &
    until grep -q 16 said; do sleep 0.02; done; kill -INT \$!; wait \$!"
grep -q '"level set build 16' bench.json.partial || { echo "FAILED: bench.json.partial lacks what was measured"; failures=$((failures + 1)); }
rm -f said bench.json.partial
left=$(ls -A)
[[ -z $left ]] || { echo "FAILED: left behind: $left"; failures=$((failures + 1)); }
exit $((failures > 0))
