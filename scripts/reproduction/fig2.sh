# Fig 2: short curls at high resolution on a still head: as they are, by Lin and by Kim on Iben's chain
source "$root/scripts/reproduction/compared.bash"
dense=("${still[@]}" "${few[@]}" --set 'groom.grid=[18, 18]')
simulate fig2_dry scenes/compare_short.toml --dry "${dense[@]}"
trial fig2_lin scenes/compare_short_lin.toml "${dense[@]}"
trial fig2_kim scenes/compare_short_kim.toml "${dense[@]}"
trial fig2_iben scenes/compare_iben.toml --set groom.length=0.12 --set groom.particles=26 --set groom.lift=0.012 "${dense[@]}"
trembling_of fig2 fig2_dry fig2_lin fig2_kim fig2_iben
whole fig2_kim "(c) the simulation ultimately diverges"
picture fig2 --label "dry" --label "Lin on Iben's chain" --label "Kim on Iben's chain" \
    fig2_dry.h5 fig2_lin.h5 fig2_kim.h5 --frame "$(last_of fig2_lin fig2_kim)"
