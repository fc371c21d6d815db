#!/usr/bin/env bash
# Another project finds the installed library, builds a program in C and one in C++ on it, and runs learned hair.
# Use: test_library.sh BUILD SOURCE MODEL OTHER        OTHER: of strands before cohesion
set -euo pipefail
build=$1 source=$2 model=$3 other=$4
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cmake --install "$build" --prefix "$folder/there" >/dev/null
cmake -S "$source/examples" -B "$folder/build" -DCMAKE_PREFIX_PATH="$folder/there" -DCMAKE_BUILD_TYPE=Release >/dev/null
cmake --build "$folder/build" >/dev/null
cat >"$folder/scene.toml" <<TOML
include = "$source/scenes/demo.toml"
[groom]
grid = [8, 8]
TOML
in_c=$("$folder/build/hair_in_c" "$folder/scene.toml" "$model")
in_cpp=$("$folder/build/hair_in_cpp" "$folder/scene.toml" "$model" 2>"$folder/refused")
grep -q 'pose: number 1 of 7 is not finite' "$folder/refused"
grep -q 'quaternion of length 2' "$folder/refused"
grep -q 'strand 0, particle 2 at no finite position' "$folder/refused"
echo "in C: $in_c; in C++: $in_cpp"
[[ $in_c == "$in_cpp" && $in_c == "64 strands, "* ]]
# Curls of 0.2 to 0.3 m hang 0.05 m or more below their roots, and no farther than they are long.
awk '{ exit !($3 > 0.05 && $3 < 0.35) }' <<<"$in_c"
if said=$("$folder/build/hair_in_cpp" "$folder/scene.toml" "$folder/absent.h5" 2>&1); then echo "an absent model ran"; exit 1; fi
echo "absent model: $said"
[[ $said == *absent.h5*"no such file"* ]]
if said=$("$folder/build/hair_in_c" "$folder/scene.toml" "$model" tpu 2>&1); then echo "an unknown device ran"; exit 1; fi
[[ $said == *"found 'tpu', allowed cpu, cuda, cuda:N"* ]]
# With the network of strands before cohesion, Eq 10 follows: tips hang a little otherwise.
before=$("$folder/build/hair_in_c" "$folder/scene.toml" "$other")
echo "before cohesion, then Eq 10: $before"
awk -v a="$before" -v b="$in_c" 'BEGIN { split(a, x, ", "); split(b, y, ", "); d = x[2] - y[2]; exit !(d != 0 && d * d < 0.0004) }'
# On a GPU, where there is one: Eq 10 is computed there too.
if "$build/bin/wetcurl" inspect device --json - | grep -A1 '"cuda_devices"' | grep -qE '^ +"[^"]+"$'; then
    for one in "$model" "$other"; do
        here=$("$folder/build/hair_in_c" "$folder/scene.toml" "$one") there=$("$folder/build/hair_in_c" "$folder/scene.toml" "$one" cuda)
        echo "on the host: $here; on a GPU: $there"
        awk -v a="$here" -v b="$there" 'BEGIN { split(a, x, ", "); split(b, y, ", "); d = x[2] - y[2]; exit !(x[1] == y[1] && d * d < 1e-6) }'
    done
fi
# What is installed shows wetcurl.h's functions and nothing else of its own.
shown=$(nm -D --defined-only "$(find "$folder/there" -name libwetcurl.so)" | awk '$2 == "T" { print $3 }' | sort)
declared=$(grep -oE 'wetcurl_[a-z_]+\(' "$source/app/library/wetcurl.h" | tr -d '(' | sort -u)
[[ -n $shown && $(comm -23 <(echo "$shown") <(echo "$declared")) == "" ]] || { echo "the library shows more than wetcurl.h: $shown"; exit 1; }
