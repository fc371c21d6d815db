# Unseen hair: the paper's networks as printed, at their width, on the 24 scenes of the data set's test
# needs: cuda
# From dry runs of 2 substeps a frame. Networks learn from 300 other scenes; the test's hair is longer, its curls wider.
networks=(root_unet_vgg19_full_2 root_recursive_full_2) seeds=(${SEEDS:-1 2 3})
make unseen/test/test_root.h5 "$root/scenes/dataset/curls.toml" -- wetcurl dataset "$root/scenes/dataset/curls.toml" -o unseen/test --device "$device" \
    --set splits.train=0 --set splits.validation=0 --set codecs=root --set low_substeps=[2]
trained_here=()
for network in "${networks[@]/%/@}"; do
    for trained in "${seeds[@]/#/unseen/$network}"; do
        make "$trained.h5" -- env WETCURL="$program" DEVICE="$device" JOBS=1 "$root/scripts/retrain" unseen "$(basename "$trained")"
        trained_here+=("$trained.h5")
        mkdir -p "$results/trainings/unseen" && cp "$trained.h5.jsonl" "$results/trainings/unseen/"
    done
done
# Errors alone are asked for, so many at a time.
make unseen/measured/report.json "${trained_here[@]}" -- env WETCURL="$program" DEVICE="$device" JOBS="$(nproc)" "$root/scripts/measure_learned" \
    unseen/test unseen/measured "${trained_here[@]}" "$root/models/weights/strand_m.h5"
# error ROW: of a row of the report [mm]; of seeds, by NAME@.*_paper, the mean
error() { number unseen/measured/report.json "[.rows[] | select(.name | test(\"^$1\$\")) | .position_mm.mean] | add / length"; }
numbers "Means of the 24 scenes" "$(jq '[.rows[] | {row: .name, method, "error [mm]": .position_mm.mean, "of length [%]": (100 * .position_rel),
    "curl radius": .curl_radius_ratio, tips: .tip_spread_ratio}]' unseen/measured/report.json)"
for network in "${networks[@]}"; do
    row "error of ${network#root_}, its quad transform, mean of ${#seeds[@]} seeds / of quad interpolation" "not printed" "$(value "$(error "$network@.*_paper") / $(error quad)")" 0 0.5 \
        "Half is our own measure of a result worth having; the item transform shows why Eq 18 cannot reach it"
done
row "error of the released strand_m / of quad interpolation" "not in the paper" "$(value "$(error strand_m) / $(error quad)")" 0 0.5 "ours, on the same runs"
