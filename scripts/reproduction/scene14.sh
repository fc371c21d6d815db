# Fig 34, third style: learned curls to the chin, wettest at the tips
# also: fig34
source "$root/scripts/reproduction/learned.bash"
learned_scene scene14 128
