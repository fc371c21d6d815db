# Sec. VI.A: tightly coiled hair, which the paper leaves to future work: coils keep their shape, wet ones tighten and clump
simulate coils scenes/coils.toml
simulate coils_dry scenes/coils.toml --dry
# As drawn: nothing has moved it yet.
simulate coils_drawn scenes/coils.toml --frames 1 --dry --set integrator.settle=0 --set "integrator.gravity=[0,0,0]"
for run in coils coils_dry coils_drawn; do inspected $run; done
compared coils_wet_against_dry coils_dry coils
row "radius of the dry coils on a turning head, last frame / as drawn" "not covered" \
    "$(value "$(fall coils_dry -1 curl_radius_mm) / $(fall coils_drawn 0 curl_radius_mm)")" 0.95 1.05 \
    "turns of 3 mm radius and 6 mm pitch, twelve a strand; the measure counts the bend around the head too: $(short "$(fall coils_drawn 0 curl_radius_mm)") mm as drawn"
row "length along the coils' axes, wet / dry" "not covered" "$(value "$(fall coils -1 axial_extent_mm) / $(fall coils_dry -1 axial_extent_mm)")" 0.8 0.99 \
    "$(short "$(fall coils -1 axial_extent_mm)") and $(short "$(fall coils_dry -1 axial_extent_mm)") mm"
row "particles of other strands within 4 mm of one, wet / dry" "not covered" "$(ratio coils_wet_against_dry crowd)" 1.1 50 "clumped"
note "The scene is ours (scenes/coils.toml)."
picture coils coils_dry.h5 coils.h5 --frame "$(frame 40)"
