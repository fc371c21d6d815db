# Fig 27: wet everywhere, at the tips, at the roots, and strand by strand
# also: scene06 scene06a scene06b scene06c scene06d
scenes 01a 06a 06b 06c 06d
for scene in 06a 06b 06c 06d; do compared scene${scene}_against_dry scene01a scene$scene; done
dry=$(number scene01a.inspect.json '.fall[-1].axial_extent_mm')
extent() { value "$(number "scene$1.inspect.json" '.fall[-1].axial_extent_mm') / $dry"; }
crowd() { value "$(number "scene$1_against_dry.json" '.others[0].crowd') / $(number "scene$1_against_dry.json" '.others[0].crowd_reference')"; }
row "length along the curls' axes, all saturated (a) / dry" "below 1: more pronounced curls" "$(extent 06a)" 0.6 0.9 "dry $(short "$dry") mm"
row "the same, tips saturated (b) / all saturated (a)" "above 1: closer to the original length" "$(value "$(extent 06b) / $(extent 06a)")" 1.01 1.4 \
    "(b) / dry: $(short "$(extent 06b)")"
row "particles of other strands within 4 mm, tips saturated (b) / all saturated (a)" "below 1: subtler clumping" \
    "$(value "$(crowd 06b) / $(crowd 06a)")" 0.1 0.97 "(a) / dry: $(short "$(crowd 06a)"), (b) $(short "$(crowd 06b)"), (c) $(short "$(crowd 06c)"), (d) $(short "$(crowd 06d)")"
row "length along the curls' axes, roots saturated (c) / dry" "below 1: curls near the roots" "$(extent 06c)" 0.6 0.97 "half of the strand is wet"
picture fig27 --saturation scene06a.h5 scene06b.h5 scene06c.h5 scene06d.h5 --frame "$(frame 200)"
picture fig27_plain scene06a.h5 scene06b.h5 scene06c.h5 scene06d.h5 --frame "$(frame 200)"
