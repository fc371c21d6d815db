# Fig 38: levels of adhesion
for strength in 100 300 1000; do
    simulate fig38_$strength scenes/scene08b.toml --set adhesion.strength=$strength
    inspected fig38_$strength
done
tallest() { falls "fig38_$1" height_mm max; }
row "height of the hair most stretched, strength 300 / 100" "above 1" "$(value "$(tallest 300) / $(tallest 100)")" 1.005 1.5 \
    "adhesion.strength [m/s²], a_max of Eq 11; at 100 $(short "$(tallest 100)") mm, at rest $(short "$(fall fig38_100 0 height_mm)")"
row "the same, 1000 / 300" "above 1: strongest" "$(value "$(tallest 1000) / $(tallest 300)")" 1.005 1.5 "at 1000 $(short "$(tallest 1000)") mm"
picture fig38 --label "adhesion 100 m/s2" --label "adhesion 300 m/s2" --label "adhesion 1000 m/s2" \
    fig38_100.h5 fig38_300.h5 fig38_1000.h5 --frame "$(falls fig38_1000 height_mm 'index(max)')"
