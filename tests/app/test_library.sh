#!/usr/bin/env bash
# Another project finds the installed library, builds a program in C and one in C++ on it, and runs learned hair.
# Use: test_library.sh BUILD SOURCE MODEL
set -euo pipefail
build=$1 source=$2 model=$3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cmake --install "$build" --prefix "$folder/there" >/dev/null
cmake -S "$source/tests/library" -B "$folder/build" -DCMAKE_PREFIX_PATH="$folder/there" -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build "$folder/build" >/dev/null
cat >"$folder/scene.toml" <<TOML
include = "$source/scenes/demo.toml"
[groom]
grid = [8, 8]
TOML
in_c=$("$folder/build/hair_in_c" "$folder/scene.toml" "$model")
in_cpp=$("$folder/build/hair_in_cpp" "$folder/scene.toml" "$model")
echo "in C: $in_c; in C++: $in_cpp"
[[ $in_c == "$in_cpp" && $in_c == "64 strands, "* ]]
# Curls of 0.2 to 0.3 m hang 0.05 m or more below their roots, and no farther than they are long.
awk '{ exit !($3 > 0.05 && $3 < 0.35) }' <<<"$in_c"
if said=$("$folder/build/hair_in_cpp" "$folder/scene.toml" "$folder/absent.h5" 2>&1); then echo "an absent model ran"; exit 1; fi
echo "absent model: $said"
[[ $said == *absent.h5*"no such file"* ]]
if "$folder/build/hair_in_c" "$folder/scene.toml" "$model" tpu 2>/dev/null; then echo "an unknown device ran"; exit 1; fi
# What is installed shows wetcurl.h's functions and nothing else of its own.
shown=$(nm -D --defined-only "$(find "$folder/there" -name libwetcurl.so)" | awk '$2 == "T" { print $3 }' | sort)
declared=$(grep -oE 'wetcurl_[a-z_]+\(' "$source/app/library/wetcurl.h" | tr -d '(' | sort -u)
[[ -n $shown && $(comm -23 <(echo "$shown") <(echo "$declared")) == "" ]] || { echo "the library shows more than wetcurl.h: $shown"; exit 1; }
