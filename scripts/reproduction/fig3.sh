# Fig 3: short curls at low resolution on a still head, by Lin on Iben's chain
source "$root/scripts/reproduction/compared.bash"
short_low_hair
trial fig3_lin scenes/compare_short_lin.toml "${still[@]}" "${few[@]}"
trembling_of fig3 short_dry fig3_lin short_iben
picture fig3 --label "dry" --label "Iben's chain alone" --label "Lin on Iben's chain" \
    short_dry.h5 short_iben.h5 fig3_lin.h5 --frame "$(last_of fig3_lin)"
