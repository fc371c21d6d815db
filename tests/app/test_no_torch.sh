#!/usr/bin/env bash
# Simulating does not load LibTorch; asking for a model does. Usage: test_no_torch.sh WETCURL SCENE
set -euo pipefail
wetcurl=$1 scene=$2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
# Libraries that the loader opened while the command ran.
loaded() { LD_DEBUG=files LD_DEBUG_OUTPUT="$folder/loader" "$@" >/dev/null 2>&1 || true; grep -ch 'libtorch' "$folder"/loader* | awk '{ n += $1 } END { print n + 0 }'; rm -f "$folder"/loader*; }

if ldd "$wetcurl" | grep -i torch; then echo "wetcurl links LibTorch"; exit 1; fi
simulated=$(loaded "$wetcurl" simulate "$scene" --dry --strands 16 --frames 2 -o "$folder/run.h5")
[[ -s $folder/run.h5 ]] || { echo "the simulation left no run"; exit 1; }
asked=$(loaded "$wetcurl" inspect model "$folder/run.h5")
echo "lines of the loader on LibTorch: simulate $simulated, inspect model $asked"
[[ $simulated == 0 && $asked != 0 ]]
