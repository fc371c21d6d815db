# Fig 6: dry curly hair while the head moves up and down: curls stay
# also: fig6
scenes 01a
simulate fig06 scenes/fig06.toml
inspected fig06
radius=$(number scene01a.inspect.json '.fall[0].curl_radius_mm')
mean=$(number fig06.inspect.json '[.fall[].curl_radius_mm] | add / length')
last=$(number fig06.inspect.json '.fall[-1].curl_radius_mm')
least=$(number fig06.inspect.json '[.fall[].curl_radius_mm] | min')
row "radius of the curls in motion, mean / at rest" "curls remain intact" "$(value "$mean / $radius")" 0.95 1.05 \
    "the mean over all frames and strands; at rest $(short "$radius") mm (scene 1a)"
row "radius of the curls at the last frame / at rest" "curls remain intact" "$(value "$last / $radius")" 0.95 1.05 \
    "nothing is lost over the run's periods"
row "least radius of the curls at any frame / at rest" "curls remain intact" "$(value "$least / $radius")" 0.9 1.05 \
    "where the head turns upward its acceleration draws the curls longest"
row "length along the curls' axes, longest frame / shortest" "hair moves" \
    "$(value "$(number fig06.inspect.json '[.fall[].axial_extent_mm] | max') / $(number fig06.inspect.json '[.fall[].axial_extent_mm] | min')")" 1.01 1.5 \
    "that the curls are stretched and shortened by the motion at all"
note "The scene is ours (scenes/fig06.toml): the paper names neither stroke nor period."
picture fig06_low fig06.h5 --frame "$(frame 206)"
picture fig06_high fig06.h5 --frame "$(frame 216)"
