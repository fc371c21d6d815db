# Fig 22: the head rolls from ear to ear: dry hair spreads, wet hair stays clumped
# also: scene03 scene03a scene03b
scenes 03a 03b
compared scene03_wet_against_dry scene03a scene03b
row "distance of tips to their four nearest, wet / dry" "below 1: dry hair disperses, wet does not scatter" \
    "$(against scene03_wet_against_dry tip_spread_ratio)" 0.5 0.95 \
    "$(short "$(against scene03_wet_against_dry tip_spread_mm)") and $(short "$(against scene03_wet_against_dry tip_spread_reference_mm)") mm, the mean over the run"
row "particles of other strands within 4 mm of one, wet / dry" "above 1: clumped" "$(ratio scene03_wet_against_dry crowd)" 1.5 50 "locks are dense all along"
row "width of the hair at its widest frame, wet / dry" "below 1" \
    "$(value "$(falls scene03b width_mm max) / $(falls scene03a width_mm max)")" 0.5 0.99 \
    "$(short "$(falls scene03b width_mm max)") and $(short "$(falls scene03a width_mm max)") mm"
picture fig22 scene03a.h5 scene03b.h5 --frame "$(frame 204)" --yaw 0
