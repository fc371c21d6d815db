# Fig 25: short curls, dry and wet
# also: scene04 scene04a scene04b
scenes 04a 04b
compared scene04_wet_against_dry scene04a scene04b
extent() { number "$1.inspect.json" '.fall[71:72][0].axial_extent_mm // .fall[-1].axial_extent_mm'; }
row "length along the curls' axes, wet / dry" "below 1: the curl typical of wet hair" "$(value "$(extent scene04b) / $(extent scene04a)")" 0.6 0.95 \
    "$(short "$(extent scene04b)") and $(short "$(extent scene04a)") mm"
row "particles of other strands within 4 mm of one, wet / dry" "above 1: cohesion" \
    "$(value "$(number scene04_wet_against_dry.json '.others[0].crowd') / $(number scene04_wet_against_dry.json '.others[0].crowd_reference')")" 1.2 50 \
    "9900 strands are dense when they are dry"
picture fig25 scene04a.h5 scene04b.h5 --frame "$(frame 71)"
