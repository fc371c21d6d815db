# Table 2: the box around hair that a ball lifts and draws, and the angle that strands make with it
# also: fig31
scenes 09 08a 08b
simulate scene09_dry scenes/scene09.toml --dry
inspected scene09_dry
note "The paper's boxes are in pixels, ours in millimetres, from the front: ratios compare. Its angle is drawn by hand; \
ours is the mean, over strands that lie on the ball, between a fifth of the strand above the first touch and a fifth \
below. Frames: the ball at the top (A, D), wet hair most stretched (B, E), after (C, F). Where the paper drew its boxes \
and arrows it does not say. Adhesion alone makes hair as tall as the paper's and leaves it as wide as it was: strands that \
nothing touches hang as wide wet as dry, and in B the ball has drawn a few aside. Curls and cohesion make it narrower."
most=$(falls scene09 height_mm 'index(max)')
table='[]'
add() {  # of NAME RUN FRAME, the paper's width, height and angle
    table=$(jq -c --arg frame "$1" --argjson at "$3" --arg paper "$4, $5, $6°" --slurpfile run "$2.inspect.json" \
        '. + [$run[0].fall[$at] | {frame: $frame, at: $at, "paper: width, height, angle": $paper, "width [mm]": .width_mm, "height [mm]": .height_mm, "angle [degrees]": (.angle_degrees // "none lies on it")}]' <<<"$table")
}
while read -r wet dry frame width_wet height_wet angle_wet width_dry height_dry angle_dry; do
    [[ $frame != most ]] || frame=$most
    frame=$(frame "$frame")
    add "$wet" scene09 "$frame" "$width_wet" "$height_wet" "$angle_wet"
    add "$dry" scene09_dry "$frame" "$width_dry" "$height_dry" "$angle_dry"
    for what in width height; do
        paper_wet=${what}_wet paper_dry=${what}_dry
        paper=$(value "${!paper_wet} / ${!paper_dry}")
        row "$what, wet / dry ($wet / $dry)" "$(short "$paper")" "$(value "$(fall scene09 "$frame" ${what}_mm) / $(fall scene09_dry "$frame" ${what}_mm)")" \
            "$(value "$paper - 0.06")" "$(value "$paper + 0.06")" \
            "within 0.06 of the paper's ratio; frame $frame; with curls and cohesion too (scene 8): $(short "$(value "$(fall scene08b "$frame" ${what}_mm) / $(fall scene08a "$frame" ${what}_mm)")")"
    done
done <<'END'
A D 84 700 800 140 770 900 115
B E most 610 1030 70 750 900 115
C F 152 610 1000 100 670 960 115
END
wet=$(fall scene09 "$(frame 84)" angle_degrees) dry=$(fall scene09_dry "$(frame 84)" angle_degrees)
row "angle of strands on the ball, wet / dry" "below 1: 70° and 115° in B, E" "$(value "$wet / $dry")" 0.3 0.9 \
    "$(short "$wet")° and $(short "$dry")°, in A and D: in B and C only tips lie on the ball, where a strand has no part below the touch. For A the paper prints the opposite, 140° and 115°"
numbers "Boxes and angles" "$table"
picture table2_a scene09.h5 scene09_dry.h5 --frame "$(frame 84)" --yaw 0
picture table2_b scene09.h5 scene09_dry.h5 --frame "$(frame "$most")" --yaw 0
picture table2_c scene09.h5 scene09_dry.h5 --frame "$(frame 152)" --yaw 0
