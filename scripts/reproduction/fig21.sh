# Fig 21: hair at rest, dry and wet: clumps, tighter curls, and what it takes to hang lower
# also: scene01 scene01a scene01b
scenes 01a 01b
simulate fig21_wet scenes/fig21.toml --frames "$(frames 96)"
simulate fig21_dry scenes/fig21.toml --frames "$(frames 96)" --dry
for run in fig21_wet fig21_dry; do inspected $run; done
compared scene01_wet_against_dry scene01a scene01b
compared fig21_wet_against_dry fig21_dry fig21_wet
last() { fall "$1" -1 "$2"; }
both() { echo "$(short "$(last "$2" "$3")") and $(short "$(last "$1" "$3")") mm"; }  # of DRY WET KEY
pair() {  # of TITLE NAME DRY WET: what Figure 21 shows, but for the weight
    local of=$2_wet_against_dry
    row "$1: particles of other strands within 4 mm of one, wet / dry" "above 1: cohesion" "$(ratio "$of" crowd)" 1.5 50 "the mean over the run"
    row "$1: distance of tips to their four nearest, wet / dry" "below 1: cohesion" "$(against "$of" tip_spread_ratio)" 0.5 0.97 \
        "$(short "$(against "$of" tip_spread_mm)") and $(short "$(against "$of" tip_spread_reference_mm)") mm"
    row "$1: radius of the curls, wet / dry" "below 1: tighter" "$(value "$(last "$4" curl_radius_mm) / $(last "$3" curl_radius_mm)")" 0.5 0.95 \
        "$(both "$3" "$4" curl_radius_mm)"
    row "$1: how far tips hang below their roots, wet / dry" "above 1: droops by its weight" "$(value "$(last "$4" drop_mm) / $(last "$3" drop_mm)")" 1.02 1.5 \
        "$(both "$3" "$4" drop_mm); from the top of the hair to its lowest tip $(both "$3" "$4" height_mm), along the curls' axes $(both "$3" "$4" axial_extent_mm)"
}
pair "scene 1" scene01 scene01a scene01b
pair "springs an eighth as stiff, water of twice the mass (scenes/fig21.toml)" fig21 fig21_dry fig21_wet

# What each parameter of the paper does to it.
table='[]'
soft=(--set bend.stiffness=0.05 --set core.stiffness=0.005)
while read -r name springs absorbed weight; do
    options=()
    [[ $springs == 1 ]] || options=("${soft[@]}")
    simulate "fig21_$name" scenes/scene01b.toml --frames "$(frames 24)" "${options[@]}" --set "wetness.absorbed=$absorbed" --set "curl.weight=$weight"
    inspected "fig21_$name"
    dry=scene01a
    [[ $springs == 1 ]] || dry=fig21_dry
    table=$(jq -c --arg springs "$springs" --argjson absorbed "$absorbed" --argjson weight "$weight" \
        --argjson drop "$(value "$(last "fig21_$name" drop_mm) / $(last $dry drop_mm)")" \
        --argjson radius "$(value "$(last "fig21_$name" curl_radius_mm) / $(last $dry curl_radius_mm)")" \
        '. + [{"bend and core, of scene 1": $springs, "wetness.absorbed": $absorbed, "curl.weight": $weight, "drop, wet / dry": $drop, "radius of the curls, wet / dry": $radius}]' <<<"$table")
done <<'END'
stiff_default 1 0.3 1
stiff_heavy 1 3 1
stiff_weak 1 0.3 0.3
stiff_heavy_weak 1 3 0.3
soft_default 1/8 0.3 1
soft_heavy 1/8 2 1
soft_heavy_weak 1/8 2 0.7
END
numbers "What makes wet hair hang lower, against dry hair of the same springs" "$table"
note "Figure 28 says that water shortens a strand by a quarter, Figure 21 that it draws hair down. Both hold at once only \
where the water's weight draws curls out by more than Eq 9 draws them in. Three numbers of the paper decide it: how much \
water hair holds (wetness.absorbed, in its own mass), how much of Eq 9 it takes (curl.weight, w_h), and how soft its curls \
are (bend and core stiffness). In scene 1, whose strands are a quarter shorter when wet, much water alone does not do it; \
with less of Eq 9, or softer curls, wet hair hangs lower, and is still tighter curled than dry hair."
picture fig21 --saturation scene01a.h5 scene01b.h5 --frame "$(frame 200)"
picture fig21_droop --label "dry" --label "wet, softer springs" \
    fig21_dry.h5 fig21_wet.h5 --frame "$(frame 95)"
