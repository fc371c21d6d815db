# Fig 12: wet curls on a head that turns, by Iben without dynamic stiffness and by our method with it
source "$root/scripts/reproduction/compared.bash"
trial long_iben_turned scenes/compare_iben.toml
simulate long_ours_turned scenes/compare_ours.toml --frames "$(frames 48)"
simulate long_dry_turned scenes/compare_head.toml --dry --frames "$(frames 48)"
first_frame=$(frame 12) beside fig12 long_dry_turned long_iben_turned long_ours_turned
row "spread of tips, Iben / ours" "above 1: scattered by strong external forces" "$(value "$(spread long_iben_turned) / $(spread long_ours_turned)")" 1.1 100 \
    "$(short "$(spread long_iben_turned)") and $(short "$(spread long_ours_turned)") of dry hair's"
picture fig12 --label "Iben's chain alone, turned" --label "ours, turned" \
    long_iben_turned.h5 long_ours_turned.h5 --frame "$(frame 38)"
