# Fig 5: short curls at low resolution on a still head, by Kim on Iben's chain
source "$root/scripts/reproduction/compared.bash"
short_low_hair
trial fig5_kim scenes/compare_short_kim.toml "${still[@]}" "${few[@]}"
trembling_of fig5 short_dry fig5_kim short_iben
picture fig5 --label "dry" --label "Iben's chain alone" --label "Kim on Iben's chain" \
    short_dry.h5 short_iben.h5 fig5_kim.h5 --frame "$(last_of fig5_kim)"
