# Fig 9: cohesion by Lin on Iben's chain: long curls as they are, on a still head, and on one that turns
source "$root/scripts/reproduction/compared.bash"
long_still lin
few_turned lin
trembling_of fig9 few_dry_still few_lin_still few_iben_still
clumping_of fig9_turned few_dry_turned few_lin_turned
picture fig9 --label "dry, still" --label "Lin on Iben's chain, still" --label "Lin on Iben's chain, turned" \
    few_dry_still.h5 few_lin_still.h5 few_lin_turned.h5 --frame "$(last_of few_lin_still few_lin_turned)"
