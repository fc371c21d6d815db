# Fig 37: levels of wetness, by the saturation and by the range of neighbours
scenes 01a
for level in 0.2 0.5 1; do simulate fig37_level_$level scenes/scene01b.toml --frames "$(frames 48)" --set wetness.level=$level; done
for radius in 0.010 0.018; do simulate fig37_radius_$radius scenes/scene01b.toml --frames "$(frames 48)" --set cohesion.radius=$radius; done
runs=(fig37_level_0.2 fig37_level_0.5 fig37_level_1 fig37_radius_0.010 fig37_radius_0.018)
for run in "${runs[@]}"; do inspected "$run"; done
compared fig37 scene01a "${runs[@]}"
extent() { fall "$1" -1 axial_extent_mm; }
crowd() { number fig37.json "[.others[] | select(.file | endswith(\"$1.h5\"))][0].crowd"; }
row "length along the curls' axes, wetness 0.5 / 0.2" "below 1: wetter" "$(value "$(extent fig37_level_0.5) / $(extent fig37_level_0.2)")" 0.7 0.99 "wetness.level, sigma"
row "the same, wetness 1 / 0.5" "below 1: wettest" "$(value "$(extent fig37_level_1) / $(extent fig37_level_0.5)")" 0.7 0.99 "as above"
row "particles of other strands within 4 mm of one, wetness 1 / 0.2" "above 1: clumped" "$(value "$(crowd fig37_level_1) / $(crowd fig37_level_0.2)")" 1.1 50 "as above"
row "the same, range of neighbours 18 mm / 10 mm" "above 1: clumped" "$(value "$(crowd fig37_radius_0.018) / $(crowd fig37_radius_0.010)")" 1.1 50 "cohesion.radius, h"
picture fig37 --label "wetness 0.2" --label "wetness 0.5" --label "wetness 1" \
    --saturation fig37_level_0.2.h5 fig37_level_0.5.h5 fig37_level_1.h5 --frame "$(frame 47)"
picture fig37_range --label "neighbours within 10 mm" --label "neighbours within 18 mm" \
    fig37_radius_0.010.h5 fig37_radius_0.018.h5 --frame "$(frame 47)"
