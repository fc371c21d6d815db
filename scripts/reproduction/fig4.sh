# Fig 4: long curls at low resolution, on Iben's chain: by Lin and by Kim on a still head, by Kim on one that turns
source "$root/scripts/reproduction/compared.bash"
long_still lin
long_still kim
few_turned kim
trembling_of fig4 few_dry_still few_lin_still few_kim_still few_iben_still
picture fig4 --label "Lin on Iben's chain, still" --label "Kim on Iben's chain, still" --label "Kim on Iben's chain, turned" \
    few_lin_still.h5 few_kim_still.h5 few_kim_turned.h5 --frame "$(last_of few_lin_still few_kim_still few_kim_turned)"
