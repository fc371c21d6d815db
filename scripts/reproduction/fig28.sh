# Fig 28: one strand, about a quarter shorter when it is wet
# also: scene07
simulate scene07_wet scenes/scene07.toml
simulate scene07_dry scenes/scene07.toml --dry
for run in scene07_wet scene07_dry; do inspected $run; done
wet=$(number scene07_wet.inspect.json .axial_extent_mm) dry=$(number scene07_dry.inspect.json .axial_extent_mm)
row "length of the strand, root to tip along the curl's axis, wet / dry" "0.75" "$(value "$wet / $dry")" 0.70 0.80 \
    "read from the figure's Y axis: 0 to 30 against 0 to 40. Ours: $(short "$wet") and $(short "$dry") mm"
picture fig28 scene07_wet.h5 scene07_dry.h5 --frame 100
