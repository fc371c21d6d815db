# Fig 6: dry curly hair while the head moves up and down: curls stay
scenes 01a
simulate fig6 scenes/fig6.toml
inspected fig6
rest=$(fall scene01a 0 curl_radius_mm)
row "radius of the curls in motion, mean / at rest" "curls remain intact" \
    "$(value "$(falls fig6 curl_radius_mm 'add / length') / $rest")" 0.95 1.05 "the mean over strands and frames; at rest $(short "$rest") mm (scene 1a)"
row "radius of the curls at the last frame / at rest" "curls remain intact" \
    "$(value "$(fall fig6 -1 curl_radius_mm) / $rest")" 0.95 1.05 "nothing is lost from period to period"
row "least radius of the curls at any frame / at rest" "curls remain intact" \
    "$(value "$(falls fig6 curl_radius_mm min) / $rest")" 0.9 1.05 "the head turns upward: gravity and a half draw the curls out"
row "length along the curls' axes, longest frame / shortest" "vertical movement" \
    "$(falls fig6 axial_extent_mm 'max / min')" 1.03 1.5 "that the motion stretches and shortens the curls at all"
note "The scene is ours (scenes/fig6.toml): the paper names neither stroke nor period."
low=$(falls fig6 axial_extent_mm '.[24:] | 24 + index(max)') high=$(falls fig6 axial_extent_mm '.[24:] | 24 + index(min)')
picture fig6_low fig6.h5 --frame "$low"
picture fig6_high fig6.h5 --frame "$high"
