# Sec. VI.I: energy: steady at rest, periodic on a turning head, never gained by hair that is let go
scenes 01b 02
energies='[.energy_joule[] | .kinetic + (.stretch // 0) + (.bend // 0) + (.twist // 0) + (.core // 0)]'
row "scene 1b, head at rest: range of kinetic and elastic energy over the last third, of their mean" "stable, no abrupt change" \
    "$(number scene01b.inspect.json "$energies | .[length * 2 / 3 | floor:] | (max - min) / (add / length)")" 0 0.01 \
    "mean $(short "$(number scene01b.inspect.json "$energies | 1e6 * add / length")") µJ"
row "scene 2, head turning: largest change from one frame to the next, of the mean" "no abrupt change" \
    "$(number scene02.inspect.json "$energies as \$e | [range(24; (\$e | length) - 1) | \$e[. + 1] - \$e[.] | fabs] | max / (\$e | add / length)")" 0 0.1 \
    "the motion drives it: it peaks with every swing"
row "scene 2: highest energy of the last turn / of the second" "stable, does not diverge" \
    "$(number scene02.inspect.json "$energies as \$e | (\$e[-48:] | max) / (\$e[48:96] | max)")" 0.97 1.03 "a turn is 48 frames"

# Hair that is let go, in double precision: kinetic, elastic and gravity's energy together.
let_go=(--set "groom.grid=[8,8]" --set motion.angle=0 --set integrator.settle=0 --precision double)
gain='[.energy_joule[].sum] as $e | [range(0; ($e | length) - 1) | $e[. + 1] - $e[.]] | max / (($e | max) - ($e | min))'
for friction in 0 0.3 2; do
    simulate energy_friction_$friction scenes/compare_ours.toml "${let_go[@]}" \
        --set "solid=[{name=\"head\", shape=\"sphere\", radius=0.095, attached=\"head\", friction=$friction}]"
    inspected energy_friction_$friction
    row "64 wet strands let go over a head of friction $friction: most that a frame gains, of what the fall loses" "damped: nothing" \
        "$(number energy_friction_$friction.inspect.json "$gain")" -1 0.0001 "96 frames of ten substeps, double precision"
done
for water in dry wet; do
    options=()
    [[ $water == wet ]] || options=(--dry)
    simulate energy_free_$water scenes/compare_ours.toml "${let_go[@]}" --set "solid=[]" "${options[@]}"
    inspected energy_free_$water
    row "the same without a head, $water" "damped: nothing" "$(number energy_free_$water.inspect.json "$gain")" -1 0.0001 "as above"
done

# Wet hair on a still head: third differences over frames, root mean square, beside a segment.
first_frame=$(frame 140) compared energy_rest scene01b scene01b
row "scene 1b: what is left of motion at rest [mm]" "no jitter" "$(number energy_rest.json '.others[0].jitter_mm')" 0 0.0025 \
    "root mean square third difference over frames from frame $(frame 140); the limit is a thousandth of a segment of 2.5 mm"
note "The paper draws the energies without numbers. Lin's and Kim's methods: \`test_solver --gtest_filter='Energy.*'\` and \`wetcurl stability\`."
chart energy scene01b.h5 scene02.h5
