#!/usr/bin/env bash
# The example fine_tune.sh, small: the installed program finds the released network, imports a hair file, and the network
# that was trained further errs less than the released one, and than the best way without a network, under a
# motion that training did not see. Follows test_library.sh.
# Use: test_fine_tune.sh BUILD SOURCE
set -euo pipefail
build=$1 source=$2
command -v jq >/dev/null || { echo "SKIP: jq is not there (scripts/setup installs it), which reads the result"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
# 12 x 12 curls of 25 cm on a cap of a head, in centimetres, z up.
awk -v side=12 -v points=80 'BEGIN {
    print "ply\nformat ascii 1.0\nelement vertex " side * side * points "\nproperty float x\nproperty float y\nproperty float z"
    print "element strand " side * side "\nproperty ushort nsegs\nend_header"
    for (row = 0; row < side; row++) for (column = 0; column < side; column++) {
        x = 12 * ((column + 0.5) / side - 0.5); y = 12 * ((row + 0.5) / side - 0.5); z = sqrt(9.5 ^ 2 - x * x - y * y)
        for (i = 0; i < points; i++) {
            t = i / (points - 1); turn = 6 * 6.28319 * t + row + 2 * column; out = 1 + 0.35 * t
            print x * out + 0.8 * t ^ 0.5 * cos(turn), y * out + 0.8 * t ^ 0.5 * sin(turn), z - 20 * t
        }
    }
    for (s = 0; s < side * side; s++) print points - 1
}' >hair.ply
PATH=$build/installed/prefix/bin:$PATH UNITS=cm UP=z NETWORK=displayed_s FRAMES=24 EPOCHS=10 "$source/examples/fine_tune.sh" hair.ply out
error_of() { jq -e ".others[$1].position_mm.mean" out/compare.json; }
without=$(error_of 0) released=$(error_of 1) tuned=$(error_of 2) strands=$(jq -e .strands out/wet.json)
echo "$strands strands; no network $without mm, released network $released mm, trained further $tuned mm"
# The grid leaves out few of the 144 roots.
awk -v n="$strands" -v a="$released" -v b="$tuned" -v c="$without" 'BEGIN { exit !(n > 100 && n <= 144 && b > 0 && b < 0.9 * a && b < 0.9 * c) }'
