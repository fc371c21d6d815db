# Fig 35: learned adhesion, a ball rises into wet hair and sinks
# also: fig35
simulate scene15_eq11 scenes/scene15.toml
make scene15_network.h5 "$root/scenes/scene15.toml" "$root/models/weights/adhesion_scene15.h5" -- wetcurl infer "$root/scenes/scene15.toml" -o scene15_network.h5 --device "$device" --json scene15_network.json
compared scene15_compare scene15_eq11 scene15_network
distance() { number scene15_compare.json ".others[0].solid_distance_mm.$1"; }
row "distance of hair to the solid, network against Eq 11, mean [mm]" "not printed" "$(distance mean)" 0 1 "1 mm is our own bound"
row "the same, 95th percentile [mm]" "not printed" "$(distance p95)" 0 1 "1 mm is our own bound"
row "the same, at most [mm]" "not printed" "$(distance max)" 0 1 \
    "the most stretched strands let go some frames earlier or later; what Eq 11 itself leaves open by rounding is as large"
row "time of a frame, network / Eq 11" "below 1 (\"real time\")" \
    "$(value "$(number scene15_network.json .seconds_per_frame.median) / $(number scene15_eq11.json .seconds_per_frame.median)")" 0 1 \
    "a network of 142 numbers in place of a formula of ten operations cannot save time in a solver"
numbers "Distances and times" "$(jq -n --slurpfile c scene15_compare.json --slurpfile a scene15_eq11.json --slurpfile b scene15_network.json '[
    {what: "positions, mean of the difference [mm]", value: $c[0].others[0].position_mm.mean},
    {what: "a frame by Eq 11, median [ms]", value: (1000 * $a[0].seconds_per_frame.median)},
    {what: "a frame by the network, median [ms]", value: (1000 * $b[0].seconds_per_frame.median)}]')"
picture scene15 scene15_eq11.h5 scene15_network.h5 --frame 126
