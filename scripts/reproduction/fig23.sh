# Fig 23: wet curls on a head that rolls from ear to ear, as scene 3's: by Lin and by Kim on Iben's chain, and by ours
source "$root/scripts/reproduction/compared.bash"
roll=(--set 'motion.axis=[0, 0, 1]' --set motion.angle=20 --set motion.period=2.0 "${few[@]}" --frames "$(frames 28)")
simulate roll_dry scenes/compare_head.toml --dry "${roll[@]}"
simulate roll_ours scenes/compare_ours.toml "${roll[@]}"
for method in lin kim; do trial roll_$method scenes/compare_roll_$method.toml "${few[@]}" --frames "$(frames 28)"; done
clumping_of fig23 roll_dry roll_lin roll_kim roll_ours
for method in lin kim; do
    row "spread of tips, ${method^} on Iben's chain / ours" "above 1: cohesion not as of wet hair" "$(value "$(spread roll_$method) / $(spread roll_ours)")" 1.1 100 \
        "$(short "$(spread roll_$method)") and $(short "$(spread roll_ours)") of dry hair's"
done
whole roll_lin "unstable"
whole roll_kim "more stable than Lin's, but tremulous"
picture fig23 --label "Lin on Iben's chain" --label "Kim on Iben's chain" --label "ours" \
    roll_lin.h5 roll_kim.h5 roll_ours.h5 --frame "$(last_of roll_lin roll_kim)"
