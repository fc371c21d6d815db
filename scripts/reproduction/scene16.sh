# Fig 36: learned short hair, 1900 strands from a dry run of 475
# also: fig36
source "$root/scripts/reproduction/learned.bash"
cpu_frames=48
learned_scene scene16 475
