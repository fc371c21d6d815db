# Fig 41: adhesion by boundary particles and by the level set, on an inclined plate (also Sec. VI.C)
# Boundary particles 4 mm apart, and as far apart as their support of 10 mm hardly bears.
inspected_scene() { make "$1.scene.json" "$root/scenes/$2.toml" -- wetcurl inspect scene "$root/scenes/$2.toml" --json "$1.scene.json" "${@:3}"; }
simulate compare_levelset scenes/compare_levelset.toml
inspected_scene compare_levelset compare_levelset
simulate compare_boundary scenes/compare_boundary.toml
inspected_scene compare_boundary compare_boundary
simulate compare_boundary_coarse scenes/compare_boundary.toml --set baseline.spacing=0.008
inspected_scene compare_boundary_coarse compare_boundary --set baseline.spacing=0.008
table='[]'
for run in levelset boundary boundary_coarse; do
    inspected compare_$run
    table=$(jq -c --arg run "$run" --slurpfile scene compare_$run.scene.json --slurpfile times compare_$run.json --slurpfile hair compare_$run.inspect.json \
        '. + [{run: $run, "bytes a hair particle": $scene[0].bytes_per_particle, "ms a frame": (1000 * $times[0].seconds_per_frame.median), "bouncing [mm]": $hair[0].bounce_mm}]' <<<"$table")
done
numbers "What each costs, and how smoothly hair slides" "$table"
of() { jq -er --arg run "$1" --arg key "$2" '.[] | select(.run == $run)[$key]' <<<"$table"; }
row "memory, boundary particles / level set" "above 1: their number increases significantly" \
    "$(value "$(of boundary "bytes a hair particle") / $(of levelset "bytes a hair particle")")" 1.1 100 "both solids are analytic here: no field is stored"
row "time a frame, boundary particles / level set" "above 1" "$(value "$(of boundary "ms a frame") / $(of levelset "ms a frame")")" 1.1 100 "4 mm apart"
row "bouncing, boundary particles 8 mm apart / level set" "above 1: no smooth motion" "$(value "$(of boundary_coarse "bouncing [mm]") / $(of levelset "bouncing [mm]")")" 1.05 1000 \
    "root mean square second difference over frames of the distance to the plate, of hair that lies on it"
row "bouncing, boundary particles 4 mm apart / level set" "above 1: no smooth motion" "$(value "$(of boundary "bouncing [mm]") / $(of levelset "bouncing [mm]")")" 1.05 1000 \
    "smooth motion is a matter of spacing, which memory and time pay for. Contact is the level set's in both: boundary particles bring adhesion alone"
picture fig41 --label "boundary particles" --label "level set (ours)" \
    compare_boundary.h5 compare_levelset.h5 --frame "$(frame 60)"
