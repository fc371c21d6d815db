# Sec. V: the paper's networks at their printed width: how their trainings on a GPU went
# The weights are too large to keep; the items of learned scenes leave the logs, and this one reads them.
note "Errors are those of the roots' positions in the geometry image (Eq 15), in pixels that hold a strand; *interpolation* is the image that the network begins from (Eq 14). Charts show the first seed of each."
for folder in "$results"/trainings/*/; do
    name=$(basename "$folder")
    logs=("$folder"*.jsonl)
    trainings=$(for log in "${logs[@]}"; do
        jq -s --arg name "$(basename "$log" .h5.jsonl)" 'map(select(.validation_mm)) as $seen | {training: $name, epochs: last.epoch, steps: last.step, seconds: last.seconds,
            "held out, at best [mm]": ($seen | map(.validation_mm) | min), "at its end [mm]": ($seen | last.validation_mm), "interpolation [mm]": ($seen | last.base_mm)}' "$log"
    done | jq -s .)
    numbers "$name" "$trainings"
    for network in unet_vgg19 recursive; do
        of_network=$(jq --arg network "$network" '[.[] | select(.training | contains($network))]' <<<"$trainings")
        row "$name, $network: worst seed's error on held-out images / interpolation's" "learns: below 1" \
            "$(jq '[.[] | ."held out, at best [mm]" / ."interpolation [mm]"] | max' <<<"$of_network")" 0 1 \
            "$(jq -r --arg gpu "$(jq -r .made.gpu "$results/${name}_cuda.json" 2>/dev/null || true)" '"\(length) trainings of \(map(.seconds) | min | round) to \(map(.seconds) | max | round) s on one \($gpu)"' <<<"$of_network")"
    done
    chart "trainings_$name" "$folder"*@1.h5.jsonl
done
