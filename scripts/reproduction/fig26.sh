# Fig 26: curl exaggeration alone, and what its weight does
# also: scene05
scenes 05
simulate scene05_dry scenes/scene05.toml --dry
simulate scene05_half scenes/scene05.toml --frames "$(frames 120)" --set curl.weight=0.5
for run in scene05_dry scene05_half; do inspected $run; done
extent() { fall "$1" "$(frame 119)" axial_extent_mm; }
row "length along the curls' axes, wet / dry" "below 1: pronounced exaggeration" "$(value "$(extent scene05) / $(extent scene05_dry)")" 0.6 0.9 \
    "$(short "$(extent scene05)") and $(short "$(extent scene05_dry)") mm; the paper shows it, without a number"
row "the same, w_h = 0.5" "between wet and dry: w_h controls the influence" "$(value "$(extent scene05_half) / $(extent scene05_dry)")" \
    "$(value "$(extent scene05) / $(extent scene05_dry) + 0.02")" 0.98 "curl.weight: $(short "$(extent scene05_half)") mm"
picture fig26 scene05_dry.h5 scene05_half.h5 scene05.h5 --frame "$(frame 119)"
