# Fig 32: wet curly hair in an air field: it streams and keeps its curls and clumps
# also: scene10
scenes 01b 10
compared scene10_against_rest scene01b scene10
row "radius of the curls in the wind / without" "curls kept" "$(against scene10_against_rest curl_radius_ratio)" 0.93 1.07 "against scene 1b, the mean over the run"
row "particles of other strands within 4 mm of one, in the wind / without" "cohesion kept, no unravelling" "$(ratio scene10_against_rest crowd)" 0.85 1.5 "as above"
row "distance of tips to their four nearest, in the wind / without" "cohesion kept" "$(against scene10_against_rest tip_spread_ratio)" 0.8 1.2 "as above"
row "how far the wind moves a particle [mm]" "strands move" "$(against scene10_against_rest position_mm.mean)" 3 200 "the mean over particles and frames"
picture fig32 scene01b.h5 scene10.h5 --frame "$(frame 200)"
