# Fig 8: curls tighten with saturation: none, weak, strong at the tips
simulate compare_curl_dry scenes/compare_curl.toml --dry
simulate compare_curl_weak scenes/compare_curl.toml --set wetness.level=0.4
simulate compare_curl_strong scenes/compare_curl.toml
for run in dry weak strong; do inspected compare_curl_$run; done
extent() { fall compare_curl_$1 -1 axial_extent_mm; }
row "length along the curls' axes, weak saturation / dry" "below 1: exaggerated" \
    "$(value "$(extent weak) / $(extent dry)")" 0.7 0.97 "tips saturated by 0.4: $(short "$(extent weak)") mm, dry $(short "$(extent dry)")"
row "length along the curls' axes, strong saturation / weak" "below 1: more exaggerated" \
    "$(value "$(extent strong) / $(extent weak)")" 0.7 0.97 "tips saturated by 1: $(short "$(extent strong)") mm"
note "The paper shows pictures without numbers."
picture fig8 --label "dry" --label "wet, weak" --label "wet, strong" \
    compare_curl_dry.h5 compare_curl_weak.h5 compare_curl_strong.h5 --frame "$(frame 95)"
