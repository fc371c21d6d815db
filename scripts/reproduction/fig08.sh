# Fig 8: curls tighten with saturation: none, weak, strong at the tips
# also: fig8
simulate compare_curl_dry scenes/compare_curl.toml --dry
simulate compare_curl_weak scenes/compare_curl.toml --set wetness.level=0.4
simulate compare_curl_strong scenes/compare_curl.toml
for run in dry weak strong; do inspected compare_curl_$run; done
dry=$(number compare_curl_dry.inspect.json '.fall[-1].axial_extent_mm')
weak=$(number compare_curl_weak.inspect.json '.fall[-1].axial_extent_mm')
strong=$(number compare_curl_strong.inspect.json '.fall[-1].axial_extent_mm')
row "length along the curls' axes, weak saturation / dry" "below 1: exaggerated" "$(value "$weak / $dry")" 0.7 0.97 \
    "tips saturated by 0.4; dry $(short "$dry") mm"
row "length along the curls' axes, strong saturation / weak" "below 1: more exaggerated" "$(value "$strong / $weak")" 0.7 0.97 \
    "tips saturated by 1; a picture without numbers in the paper"
picture fig08 compare_curl_dry.h5 compare_curl_weak.h5 compare_curl_strong.h5 --frame "$(frame 95)"
