# Fig 34, first style: learned loose waves, wettest at the tips
# also: fig34
source "$root/scripts/reproduction/learned.bash"
learned_scene scene12 128
