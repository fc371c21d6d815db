# Fig 39: levels of stiffness (Eq 13)
for wet in 0 4 40; do
    simulate fig39_$wet scenes/scene02.toml --frames "$(frames 160)" --set stiffness.wet=$wet
    inspected fig39_$wet
done
kinetic() { number "fig39_$1.inspect.json" "[.energy_joule[].kinetic] | $2"; }
for steps in "4 0" "40 4"; do
    read -r stiff soft <<<"$steps"
    row "kinetic energy of the turning hair, stiffness.wet $stiff / $soft" "below 1: stiffer" \
        "$(value "$(kinetic "$stiff" 'add / length') / $(kinetic "$soft" 'add / length')")" 0.3 0.999 \
        "the mean of the run: $(short "$(value "1e6 * $(kinetic "$stiff" 'add / length')")") and $(short "$(value "1e6 * $(kinetic "$soft" 'add / length')")") µJ; at most $(short "$(value "1e6 * $(kinetic "$stiff" max)")") and $(short "$(value "1e6 * $(kinetic "$soft" max)")"). stiffness.wet [1/s] is -ln(Upsilon_0) / dt"
done
picture fig39 fig39_0.h5 fig39_4.h5 fig39_40.h5 --frame "$(frame 132)"
