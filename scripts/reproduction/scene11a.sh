# Fig 33, low resolution: learned wet curls, 512 strands from a dry run of 128
# also: fig33
source "$root/scripts/reproduction/learned.bash"
learned_scene scene11a 128
