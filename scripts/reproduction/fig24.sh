# Fig 24: wet hair on a head that turns from side to side: nothing tangles
# also: scene02
scenes 02
# Two seconds a turn, 48 frames; the first turn begins from rest.
of_turn() { number scene02.inspect.json "[.fall[$1:$2][].$3] | add / length"; }
frames_all=$(number scene02.json .frames)
for what in curl_radius_mm width_mm drop_mm; do
    row "$what, mean of the last turn / of the second" "no tangling" \
        "$(value "$(of_turn $((frames_all - 48)) "$frames_all" $what) / $(of_turn 48 96 $what)")" 0.98 1.02 \
        "hair that tangles would lose its curls, narrow or shorten from turn to turn"
done
picture fig24_left scene02.h5 --frame "$(frame 204)"
picture fig24_right scene02.h5 --frame "$(frame 228)"
