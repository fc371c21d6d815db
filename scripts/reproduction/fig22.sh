# Fig 22: the head rolls from ear to ear: dry hair spreads, wet hair stays clumped
# also: scene03 scene03a scene03b
scenes 03a 03b
compared scene03_wet_against_dry scene03a scene03b
at='.others[0]'
row "distance of tips to their four nearest, wet / dry" "below 1: dry disperses, wet does not scatter" \
    "$(number scene03_wet_against_dry.json "$at.tip_spread_ratio")" 0.5 0.95 \
    "$(short "$(number scene03_wet_against_dry.json "$at.tip_spread_mm")") and $(short "$(number scene03_wet_against_dry.json "$at.tip_spread_reference_mm")") mm, the mean over the run"
row "particles of other strands within 4 mm of one, wet / dry" "above 1: clumped" \
    "$(value "$(number scene03_wet_against_dry.json "$at.crowd") / $(number scene03_wet_against_dry.json "$at.crowd_reference")")" 1.5 50 \
    "locks are dense all along"
widest() { number "$1.inspect.json" '[.fall[].width_mm] | max'; }
row "width of the hair at its widest frame, wet / dry" "below 1" "$(value "$(widest scene03b) / $(widest scene03a)")" 0.5 0.99 \
    "$(short "$(widest scene03b)") and $(short "$(widest scene03a)") mm"
picture fig22 scene03a.h5 scene03b.h5 --frame "$(frame 204)"
