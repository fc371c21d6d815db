# Fig 4: long curls at low resolution, on Iben's chain: by Lin and by Kim on a still head, by Kim on one that turns
source "$root/scripts/reproduction/compared.bash"
long_still lin
long_still kim
trial long_kim_turned scenes/compare_kim_iben.toml
trembling_of fig4 long_dry_still long_lin_still long_kim_still long_iben_still
picture fig4 long_lin_still.h5 long_kim_still.h5 long_kim_turned.h5 --frame "$(last_of long_lin_still long_kim_still long_kim_turned)"
