# Fig 9: cohesion by Lin on Iben's chain: long curls as they are, on a still head, and on one that turns
source "$root/scripts/reproduction/compared.bash"
long_still lin
trial long_lin_turned scenes/compare_lin_iben.toml
simulate long_dry_turned scenes/compare_head.toml --dry --frames "$(frames 48)"
trembling_of fig9 long_dry_still long_lin_still long_iben_still
clumping_of fig9_turned long_dry_turned long_lin_turned
picture fig9 long_dry_still.h5 long_lin_still.h5 long_lin_turned.h5 --frame "$(last_of long_lin_still long_lin_turned)"
