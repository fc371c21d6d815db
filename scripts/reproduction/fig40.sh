# Fig 40: time of every frame, by stage
scenes 01a 01b 02 03a 03b 04a 04b 05 08a 08b 10
of_wetness() { number "$1.inspect.json" '.last_stage_seconds | ((.neighbours // 0) + (.cohesion // 0)) / add'; }
for scene in 01b 04b 08b; do
    row "scene $scene: share of the last frame that neighbours and cohesion take" "a relatively large load" "$(of_wetness scene$scene)" 0.3 0.99 \
        "Eq 10 with $(short "$(number scene$scene.json .neighbours_mean)") neighbours a wet particle"
done
for scene in 01a 04a; do
    row "scene $scene: mean seconds a frame" "not significant" "$(number scene$scene.json .seconds_per_frame.mean)" 0 0.5 "dry; limit: half a second"
done
row "all scenes: longest frame / mean, the largest" "1.41 (scene 3b, Table 3)" \
    "$(jq -s '[.[].seconds_per_frame | .max / .mean] | max' scene{01a,01b,02,03a,03b,04a,04b,05,08a,08b,10}.json)" 1 3 \
    "that no frame stands out, as none does in the paper's chart"
chart fig40 --time scene01a.h5 scene01b.h5 scene02.h5
chart fig40_roll --time scene03a.h5 scene03b.h5 scene10.h5
chart fig40_dense --time scene04a.h5 scene04b.h5 scene05.h5
chart fig40_ball --time scene08a.h5 scene08b.h5
