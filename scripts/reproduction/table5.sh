# Table 5: what wetness costs: time of dry frames over that of wet ones
scenes 01a 01b 03a 03b 04a 04b 08a 08b
while read -r pair paper; do
    dry=$(number scene${pair}a.json .seconds_per_frame.mean) wet=$(number scene${pair}b.json .seconds_per_frame.mean)
    row "mean time, ${pair}a / ${pair}b" "$paper" "$(value "$dry / $wet")" "$(value "$paper * 0.75")" 1.05 \
        "$(short "$dry") and $(short "$wet") s, $(short "$(number scene${pair}b.json .neighbours_mean)") neighbours a wet particle; agrees from three quarters of the paper's ratio"
done <<'END'
01 0.436
03 0.451
04 0.221
08 0.954
END
note "Wet frames cost more beside dry ones than the paper's, because dry ones are cheap here: both are faster than the \
paper's (table3). Eq 10 sees more neighbours than the paper's 20 to 50 at the radii that clump hair this sparse. The \
paper's caption names the learned form; its times are those of its simulation (Table 3)."
