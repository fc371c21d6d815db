# Fig 10: cohesion by Kim on Iben's chain: long curls as they are, on a still head, and on one that turns
source "$root/scripts/reproduction/compared.bash"
long_still kim
trial long_kim_turned scenes/compare_kim_iben.toml
simulate long_dry_turned scenes/compare_head.toml --dry --frames "$(frames 48)"
trembling_of fig10 long_dry_still long_kim_still long_iben_still
clumping_of fig10_turned long_dry_turned long_kim_turned
picture fig10 long_dry_still.h5 long_kim_still.h5 long_kim_turned.h5 --frame "$(last_of long_kim_still long_kim_turned)"
