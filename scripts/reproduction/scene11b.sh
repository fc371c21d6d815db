# Fig 33, high resolution: learned wet curls, 2048 strands from a dry run of 512
# also: fig33
source "$root/scripts/reproduction/learned.bash"
cpu_frames=48
learned_scene scene11b 512
