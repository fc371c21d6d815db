# Fig 39: levels of stiffness (Eq 13)
for wet in 0 4 40; do
    simulate fig39_$wet scenes/scene02.toml --frames "$(frames 160)" --set stiffness.wet=$wet
    inspected fig39_$wet
done
kinetic() { number "fig39_$1.inspect.json" "[.energy_joule[].kinetic * 1e6] | $2"; }  # [µJ] of STIFFNESS FILTER
mean='add / length'
for steps in "4 0" "40 4"; do
    read -r stiff soft <<<"$steps"
    row "kinetic energy of the turning hair, stiffness.wet $stiff / $soft" "below 1: stiffer" \
        "$(value "$(kinetic "$stiff" "$mean") / $(kinetic "$soft" "$mean")")" 0.3 0.999 \
        "the mean of the run: $(short "$(kinetic "$stiff" "$mean")") and $(short "$(kinetic "$soft" "$mean")") µJ; at most \
$(short "$(kinetic "$stiff" max)") and $(short "$(kinetic "$soft" max)")"
done
note "stiffness.wet [1/s] is -ln(Upsilon_0) / dt of the paper's factor a step; beside it 0 is no damping at all."
picture fig39 --label "stiffness.wet 0" --label "stiffness.wet 4 /s" --label "stiffness.wet 40 /s" \
    fig39_0.h5 fig39_4.h5 fig39_40.h5 --frame "$(frame 132)"
