# Fig 25: short curls, dry and wet
# also: scene04 scene04a scene04b
scenes 04a 04b
compared scene04_wet_against_dry scene04a scene04b
at=$(frame 71)
row "length along the curls' axes, wet / dry" "below 1: the curl typical of wet hair" \
    "$(value "$(fall scene04b "$at" axial_extent_mm) / $(fall scene04a "$at" axial_extent_mm)")" 0.6 0.95 \
    "$(short "$(fall scene04b "$at" axial_extent_mm)") and $(short "$(fall scene04a "$at" axial_extent_mm)") mm"
row "particles of other strands within 4 mm of one, wet / dry" "above 1: cohesion" "$(ratio scene04_wet_against_dry crowd)" 1.2 50 \
    "9900 strands are dense when they are dry, too"
row "distance of tips to their four nearest, wet / dry" "below 1: cohesion" "$(against scene04_wet_against_dry tip_spread_ratio)" 0.3 0.95 \
    "$(short "$(against scene04_wet_against_dry tip_spread_mm)") and $(short "$(against scene04_wet_against_dry tip_spread_reference_mm)") mm"
picture fig25 scene04a.h5 scene04b.h5 --frame "$at"
