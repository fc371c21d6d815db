# Fig 10: cohesion by Kim on Iben's chain: long curls as they are, on a still head, and on one that turns
source "$root/scripts/reproduction/compared.bash"
long_still kim
few_turned kim
trembling_of fig10 few_dry_still few_kim_still few_iben_still
clumping_of fig10_turned few_dry_turned few_kim_turned
picture fig10 --label "dry, still" --label "Kim on Iben's chain, still" --label "Kim on Iben's chain, turned" \
    few_dry_still.h5 few_kim_still.h5 few_kim_turned.h5 --frame "$(last_of few_kim_still few_kim_turned)"
