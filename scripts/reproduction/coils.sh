# Sec. VI.A: tightly coiled hair, which the paper leaves to future work: coils keep their shape, wet ones tighten and clump
simulate coils scenes/coils.toml
simulate coils_dry scenes/coils.toml --dry
for run in coils coils_dry; do inspected $run; done
compared coils_wet_against_dry coils_dry coils
last() { number "$1.inspect.json" ".fall[-1].$2"; }
row "radius of the dry coils on a turning head, last frame / as drawn" "not covered" "$(value "$(last coils_dry curl_radius_mm) / 3")" 0.85 1.15 \
    "$(short "$(last coils_dry curl_radius_mm)") mm; drawn with 3 mm and a pitch of 6 mm, twelve turns a strand"
row "length along the coils' axes, wet / dry" "not covered" "$(value "$(last coils axial_extent_mm) / $(last coils_dry axial_extent_mm)")" 0.8 0.99 \
    "$(short "$(last coils axial_extent_mm)") and $(short "$(last coils_dry axial_extent_mm)") mm"
row "particles of other strands within 4 mm of one, wet / dry" "not covered" \
    "$(value "$(number coils_wet_against_dry.json '.others[0].crowd') / $(number coils_wet_against_dry.json '.others[0].crowd_reference')")" 1.1 50 "clumped"
note "The scene is ours (scenes/coils.toml)."
picture coils coils_dry.h5 coils.h5 --frame "$(frame 40)"
