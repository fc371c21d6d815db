# Fig 24: wet hair on a head that turns from side to side: nothing tangles
# also: scene02
scenes 02
# A turn is two seconds, 48 frames; the first begins from rest.
for what in "radius of the curls:curl_radius_mm" "width of the hair:width_mm" "tips below their roots:drop_mm" "length along the curls' axes:axial_extent_mm"; do
    row "${what%:*}, mean of the last turn / of the second" "no tangling" \
        "$(falls scene02 "${what#*:}" '(.[-48:] | add) / (.[48:96] | add)')" 0.98 1.02 "hair that tangles would change from turn to turn"
done
picture fig24_left scene02.h5 --frame "$(frame 204)"
picture fig24_right scene02.h5 --frame "$(frame 228)"
