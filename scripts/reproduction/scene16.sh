# Fig 36: learned short hair, 1900 strands from a dry run of 475
# also: fig36
source "$root/scripts/reproduction/learned.bash"
cpu_frames=48
learned_scene scene16 475
# Fig 40 (l): time of every frame of the learned run.
chart scene16_times --time scene16/wet.h5 "scene16/${papers[0]}@1_paper.h5" scene16/displayed.h5
