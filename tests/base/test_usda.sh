#!/usr/bin/env bash
# USD text beside the libraries of other programs: Pixar's own (usd-core) and tinyusdz. They read what usda_probe
# writes, and usda_probe reads what Pixar's writes.
#
#   test_usda.sh BUILD_DIR USDA_PROBE
#
# Ends with 77, and a line SKIP, where these libraries cannot be had.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
build=$1 probe=$2
python=$("$here/../venv.sh" "$build" usd-core tinyusdz) || exit $?
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
"$python" "$here/check_usda.py" "$probe" "$scratch"
