# Fig 11: cohesion by our method: long curls as they are, on a still head, and on one that turns
source "$root/scripts/reproduction/compared.bash"
long_still ours
simulate long_ours_turned scenes/compare_ours.toml --frames "$(frames 48)"
simulate long_dry_turned scenes/compare_head.toml --dry --frames "$(frames 48)"
trembling_of fig11 long_dry_still long_ours_still
clumping_of fig11_turned long_dry_turned long_ours_turned
picture fig11 --label "dry, still" --label "ours, still" --label "ours, turned" \
    long_dry_still.h5 long_ours_still.h5 long_ours_turned.h5 --frame "$(frame 23)"
