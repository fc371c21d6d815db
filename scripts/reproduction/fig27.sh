# Fig 27: wet everywhere, at the tips, at the roots, and strand by strand
# also: scene06 scene06a scene06b scene06c scene06d
scenes 01a 06a 06b 06c 06d
for scene in 06a 06b 06c 06d; do compared scene${scene}_against_dry scene01a scene$scene; done
extent() { value "$(fall "scene$1" -1 axial_extent_mm) / $(fall scene01a -1 axial_extent_mm)"; }
crowd() { ratio "scene$1_against_dry" crowd; }
row "length along the curls' axes, wet everywhere (a) / dry" "below 1: more pronounced curls" "$(extent 06a)" 0.6 0.9 \
    "dry $(short "$(fall scene01a -1 axial_extent_mm)") mm (scene 1a)"
row "the same, wet at the tips (b) / everywhere (a)" "above 1: closer to the original length" "$(value "$(extent 06b) / $(extent 06a)")" 1.01 1.4 \
    "(b) / dry: $(short "$(extent 06b)")"
row "particles of other strands within 4 mm of one, wet at the tips (b) / everywhere (a)" "below 1: subtler clumping" "$(value "$(crowd 06b) / $(crowd 06a)")" 0.1 0.97 \
    "over the dry hair's: (a) $(short "$(crowd 06a)"), (b) $(short "$(crowd 06b)"), (c) $(short "$(crowd 06c)"), (d) $(short "$(crowd 06d)")"
row "length along the curls' axes, wet at the roots (c) / dry" "below 1: wet curls near the roots" "$(extent 06c)" 0.6 0.97 "the lower half is dry"
tips() { against "scene$1_against_dry" tip_spread_mm; }
row "distance of tips to their four nearest, strand by strand (d) / everywhere (a)" "above 1: strands look tangled" "$(value "$(tips 06d) / $(tips 06a)")" 1.02 1.5 \
    "$(short "$(tips 06d)") and $(short "$(tips 06a)") mm"
picture fig27_saturation --saturation scene06a.h5 scene06b.h5 scene06c.h5 scene06d.h5 --frame "$(frame 200)"
picture fig27 scene06a.h5 scene06b.h5 scene06c.h5 scene06d.h5 --frame "$(frame 200)"
