#!/usr/bin/env bash
# Results do not change by accident: displayed positions of every shipped scene, of every released network and the weights
# of short trainings are, to the bit, those of tests/app/hashes.tsv.
#
#   test_hashes.sh PROGRAM PROJECT           compares
#   test_hashes.sh PROGRAM PROJECT --print   prints the table's lines for this compiler and instruction set, to add to it
#
# Scenes are cut to 6 x 6 strands and 3 frames. A line of the table: compiler and instruction set, what, hash. Bits hold
# for one compiler and -march; without a line for them the test is skipped. Without networks in PROGRAM the lines
# of networks are left out. Networks run on one thread, with LibTorch's kernels for AVX2.
set -euo pipefail
program=$(realpath "$1") project=$2 print=${3:-}
export OMP_WAIT_POLICY=passive OPENBLAS_NUM_THREADS=1
export ATEN_CPU_CAPABILITY=avx2 ONEDNN_MAX_CPU_ISA=AVX2 OPENBLAS_CORETYPE=Haswell MKL_CBWR=AVX2
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

text_of() { sed -n "0,/^ *\"$1\": /s/^ *\"$1\": \"\(.*\)\".*/\1/p"; }  # KEY: the first of that name in JSON
device=$("$program" inspect device --json -)
key="$(text_of compiler <<<"$device" | cut -d. -f1,2), $(text_of instruction_set <<<"$device")"
table=$project/tests/app/hashes.tsv
if [[ -z $print ]] && ! grep -q "^$key	" "$table"; then
    echo "SKIP: $table has no line of $key; --print makes them"
    exit 77
fi
wetcurl() { "$program" "$@" --quiet --overwrite --threads 1 >/dev/null; }

found=
found_hash() { found+="$key	$1	$2"$'\n'; }
of_run() { found_hash "$1" "$("$program" inspect run "$2" --json - | text_of hash)"; }

small=(--frames 3 --set 'groom.grid=[6,6]')
for scene in "$project"/scenes/*.toml; do
    [[ $scene != *_recipe.toml ]] || continue
    name=$(basename "$scene" .toml)
    wetcurl simulate "$scene" "${small[@]}" -o run.h5
    of_run "scene $name" run.h5
    [[ $name != compare_* ]] || continue
    wetcurl simulate "$scene" "${small[@]}" --precision double -o run.h5
    of_run "scene $name, double" run.h5
done

if "$program" inspect model "$project/models/weights/displayed_s.h5" --json - >/dev/null 2>&1; then
    demo=$project/scenes/demo.toml
    grid=(--frames 6 --set 'groom.grid=[8,8]')
    wetcurl simulate "$demo" "${grid[@]}" --dry --strands 16 -o dry_low.h5
    wetcurl simulate "$demo" "${grid[@]}" --dry --guides 16 -o guides.h5
    wetcurl simulate "$demo" "${grid[@]}" --strands 16 --before-cohesion -o wet_low.h5
    wetcurl simulate "$demo" "${grid[@]}" -o wet.h5
    for model in "$project"/models/weights/*.h5; do
        name=$(basename "$model" .h5)
        case $name in
            adhesion_scene15)
                # until its ball has touched the hair
                wetcurl infer "$project/scenes/scene15.toml" --frames 40 --set 'groom.grid=[6,6]' -o learned.h5 ;;
            *_wet) wetcurl infer wet_low.h5 --model "$model" -o learned.h5 ;;
            displayed_h) wetcurl infer guides.h5 --model "$model" -o learned.h5 ;;
            *) wetcurl infer dry_low.h5 --model "$model" -o learned.h5 ;;
        esac
        of_run "network $name" learned.h5
    done
    for codec in strand root; do
        wetcurl encode dry_low.h5 wet.h5 --codec $codec -o pairs.h5
        how=(--arch strand_depthwise --width 0.125)
        [[ $codec == strand ]] || how=(--arch unet_vgg19 --width 0.0625)
        wetcurl train sr pairs.h5 "${how[@]}" --set epochs=2 --seed 1 -o model.h5
        found_hash "training ${how[1]}" "$("$program" inspect model model.h5 --json - | text_of hash)"
    done
fi
[[ -z $print ]] || { printf '%s' "$found"; exit; }

failures=0
while IFS=$'\t' read -r _ what hash; do
    expected=$(awk -F'\t' -v key="$key" -v what="$what" '$1 == key && $2 == what { print $3 }' "$table")
    if [[ -z $hash || $hash != "$expected" ]]; then
        echo "FAILED: $what: found '$hash', expected '${expected:-no line of the table}'"
        failures=$((failures + 1))
    fi
done < <(printf '%s' "$found")
echo "$(grep -c . <<<"$found") hashes of $key compared"
exit $((failures > 0))
