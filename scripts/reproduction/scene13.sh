# Fig 34, second style: learned tight ringlets, wettest at the tips
# also: fig34
source "$root/scripts/reproduction/learned.bash"
learned_scene scene13 128
