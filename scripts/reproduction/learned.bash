# The learned scenes of the paper (Fig 33, 34, 36): what their items share.
#
# learned_scene SCENE LOW_STRANDS: simulates the scene (LOW_STRANDS of its strands dry, all of them wet), trains networks on
# the first four fifths of its frames, and measures them, and every way without a network, on
#   held out: the last fifth of the frames, and
#   unseen: other hair (another seed) on a head that nods, of which training saw nothing;
# on the last `compared_frames` of both where the item sets it.
# The paper's networks have the paper's width on a GPU, with three seeds, and a small width on the CPU.

# On the CPU scenes are cut: the physics is the same, and training sees fewer frames.
learned_settings() {
    if [[ $device == cpu ]]; then
        frames=${FRAMES:-${cpu_frames:-96}} unseen_frames=${UNSEEN_FRAMES:-48} seeds=(1) width=0.25 paper_epochs=${PAPER_EPOCHS:-40}
    else
        frames=${FRAMES:-160} unseen_frames=${UNSEEN_FRAMES:-96} seeds=(${SEEDS:-1 2 3}) width=1 paper_epochs=${PAPER_EPOCHS:-1000}
    fi
    precision=float
    [[ $device == cpu ]] || precision=bfloat16
}

# Other hair under another motion.
unseen=(--seed 7 --set 'motion.axis=[1,0,0]' --set motion.angle=15 --set motion.period=1.4)

# runs_of FOLDER FRAMES OPTION...: wet, dry at low resolution and, for the networks of strands, wet so and wet cheaply.
runs_of() {
    # Edges of any length from low-resolution runs: how far each way errs is what is asked.
    local folder=$1 frames=$2 any=(--set integrator.allow_stretch=1e9)
    shift 2
    simulate "$folder/wet" "$scene_file" --frames "$frames" "$@"
    simulate "$folder/dry_low" "$scene_file" --dry --strands "$low" --frames "$frames" "${any[@]}" "$@"
    [[ ${#rows_with[@]} -gt 0 ]] || return 0
    simulate "$folder/wet_low" "$scene_file" --strands "$low" --before-cohesion --frames "$frames" "${any[@]}" "$@"
    # The simulation itself with less work: 4 substeps, Eq 10 every 12.5 mm in over-relaxed sweeps.
    simulate "$folder/wet_cheap" "$scene_file" --frames "$frames" --set integrator.substeps=4 --set cohesion.spacing=0.0125 --set cohesion.relaxation=3.4 "$@"
}

# trained MODEL PAIRS OPTION...
trained() {
    local model=$1 pairs=$2
    shift 2
    make "$model.h5" "$pairs" -- wetcurl train sr "$pairs" -o "$model.h5" --json "$model.json" --device "$device" --set validation=0.2 "$@"
    trainings+=("$model")
    # Weights of the paper's width are too large to keep; their logs are not.
    [[ $device == cpu || $model != *@* ]] || { mkdir -p "$results/trainings/$scene" && cp "$model.h5.jsonl" "$results/trainings/$scene/"; }
}
trainings=()

# inferred NAME FOLDER INPUT OPTION...: FOLDER/NAME.h5
inferred() {
    local name=$1 folder=$2 input=$3 inputs=() word where=(--device "$device")
    shift 3
    for word in "$@"; do [[ $word != *.h5 ]] || inputs+=("$word"); done
    [[ " $* " != *" --interpolate "* || " $* " == *" --cohesion "* ]] || where=()
    make "$folder/$name.h5" "$folder/$input.h5" "${inputs[@]}" -- wetcurl infer "$folder/$input.h5" -o "$folder/$name.h5" "${where[@]}" "$@"
}

# Rows without a network, and with one that is not the paper's.
rows_without=(nearest quad core rest_9_10 rest_9_10_settled wet_low_quad wet_low_core wet_low_rest_9_10 wet_cheap)
rows_with=(strands displayed tuned strand_m displayed_m strand_m_wet)
papers=(unet_vgg19 recursive_residual)

# row_in FOLDER ROW: FOLDER/ROW.h5, of the runs there.
row_in() {
    local folder=$1 row=$2 weights=$root/models/weights
    case $row in
        wet_cheap) ;;  # simulated
        nearest | quad | core) inferred "$row" "$folder" dry_low --interpolate "$row" ;;
        rest_9_10) inferred "$row" "$folder" dry_low --interpolate rest --wet-shape --cohesion ;;
        rest_9_10_settled) inferred "$row" "$folder" dry_low --interpolate rest --wet-shape --cohesion --settled ;;
        wet_low_rest_9_10) inferred "$row" "$folder" wet_low --interpolate rest --wet-shape --cohesion ;;
        wet_low_*) inferred "$row" "$folder" wet_low --interpolate "${row#wet_low_}" ;;
        strands | displayed | tuned) inferred "$row" "$folder" dry_low --model "$scene/models/$row.h5" ;;
        strand_m_wet) inferred "$row" "$folder" wet_low --model "$weights/$row.h5" ;;
        strand_m | displayed_m) inferred "$row" "$folder" dry_low --model "$weights/$row.h5" ;;
        *_paper | *_core) inferred "$row" "$folder" dry_low --model "$scene/models/${row%_*}.h5" --reconstruct "${row##*_}" ;;
    esac
}

# title_of ROW
title_of() {
    local seed=${1#*@}
    case $1 in
        nearest) echo "nearest guide" ;;
        quad) echo "quad interpolation" ;;
        core) echo "core and detail" ;;
        rest_9_10) echo "rest shape with Eq 9, carried, then Eq 10" ;;
        rest_9_10_settled) echo "the same, settled" ;;
        wet_low_quad) echo "wet low-resolution run, quad interpolation" ;;
        wet_low_core) echo "wet low-resolution run, core and detail" ;;
        wet_low_rest_9_10) echo "wet low-resolution run, rest shape with Eq 9, then Eq 10" ;;
        wet_cheap) echo "wet simulation, 4 substeps, Eq 10 every 12.5 mm, over-relaxed" ;;
        strands) echo "network: strand_mlp trained here, then Eq 10" ;;
        displayed) echo "network: strand_depthwise of displayed strands, trained here" ;;
        tuned) echo "network: strand_m, released, then trained here, then Eq 10" ;;
        strand_m | displayed_m) echo "network: $1, released, never saw this scene" ;;
        strand_m_wet) echo "network: strand_m_wet, released, from the wet low-resolution run" ;;
        *_paper) echo "network: the paper's ${1%@*}, width $width, seed ${seed%_*}, its quad transform" ;;
        *_core) echo "network: the paper's ${1%@*}, width $width, seed ${seed%_*}, core and detail" ;;
    esac
}

learned_scene() {
    scene=$1 low=$2
    scene_file=$root/scenes/$scene.toml
    learned_settings
    local row rows=("${rows_without[@]}" "${rows_with[@]}") name seed titles held_out
    runs_of "$scene" "$frames"
    runs_of "$scene/unseen" "$unseen_frames" "${unseen[@]}"

    if [[ ${#rows_with[@]} -gt 0 ]]; then
        make "$scene/pairs_strand.h5" "$scene/dry_low.h5" "$scene/wet.h5" -- wetcurl encode "$scene/dry_low.h5" "$scene/wet.h5" -o "$scene/pairs_strand.h5"
        trained "$scene/models/strands" "$scene/pairs_strand.h5" --recipe "$root/scenes/learned_recipe.toml" --seed 1
        # The released network goes on learning, on this scene.
        trained "$scene/models/tuned" "$scene/pairs_strand.h5" --recipe "$root/scenes/learned_recipe.toml" --from "$root/models/weights/strand_m.h5" \
            --set epochs=8 --set learning_rate=3e-4 --seed 1
        trained "$scene/models/displayed" "$scene/pairs_strand.h5" --recipe "$root/scenes/learned_recipe.toml" --arch strand_depthwise --width 0.5 --set target=displayed --seed 1
    fi
    make "$scene/pairs_root.h5" "$scene/dry_low.h5" "$scene/wet.h5" -- wetcurl encode "$scene/dry_low.h5" "$scene/wet.h5" --codec root -o "$scene/pairs_root.h5"
    for name in "${papers[@]}"; do
        for seed in "${measured_seeds[@]:-${seeds[@]}}"; do rows+=("$name@${seed}_paper" "$name@${seed}_core"); done
        for seed in "${seeds[@]}"; do
            trained "$scene/models/$name@$seed" "$scene/pairs_root.h5" --arch "$name" --width "$width" --seed "$seed" \
                --set "epochs=$paper_epochs" --set "precision=$precision" --set validate_every=20
        done
    done
    for row in "${rows[@]}"; do row_in "$scene" "$row"; row_in "$scene/unseen" "$row"; done

    held_out=$((frames - frames / 5))
    first_frame=$((${compared_frames:-0} ? frames - compared_frames : held_out)) compared "$scene/held_out" "$scene/wet" "${rows[@]/#/$scene/}"
    first_frame=$((${compared_frames:-0} ? unseen_frames - compared_frames : 1)) compared "$scene/unseen/all" "$scene/unseen/wet" "${rows[@]/#/$scene/unseen/}"

    # The table: a row's titles and its entries in both comparisons, by file.
    titles=$(for row in "${rows[@]}"; do jq -n --arg row "$row" --arg title "$(title_of "$row")" '{$row, $title}'; done | jq -s .)
    table_of_rows=$(jq -n --argjson titles "$titles" --slurpfile held "$scene/held_out.json" --slurpfile unseen "$scene/unseen/all.json" '
        def named($c; $row): $c[0].others[] | select((.file | split("/") | last) == $row + ".h5");
        [$titles[] | .row as $row | named($held; $row) as $h | named($unseen; $row) as $u |
         {row: .title, "held out [mm]": $h.position_mm.mean, "unseen [mm]": $u.position_mm.mean, "of length": (100 * $u.position_rel), F1: $u.f1_3mm_30deg,
          "curl radius": $u.curl_radius_ratio, "tips": $u.tip_spread_ratio, locks: ($u.crowd / $u.crowd_reference), "ms a frame": (1000 * $h.seconds_per_frame)}]')
    simulation_ms=$(jq '1000 * .reference_seconds_per_frame' "$scene/held_out.json")
    table_of_rows=$(jq --argjson ms "$simulation_ms" '[{row: "wet simulation: the reference", "held out [mm]": 0, "unseen [mm]": 0, "of length": 0, F1: 1, "curl radius": 1, tips: 1, locks: 1, "ms a frame": $ms}] + .' <<<"$table_of_rows")

    note "$frames frames of the scene, of which training saw the first $held_out; unseen: $unseen_frames frames of other hair on a head that nods. ${compared_frames:+Of both the last $compared_frames frames are compared. }The paper's networks were trained for $paper_epochs epochs in $precision. Errors are means of the distance of displayed particles from the wet simulation's; curl radius, tips and locks are shares of its own, on unseen hair, and F1 is the share of particles that have one of the other run within 3 mm and 30 degrees: of these numbers it tells best what the eye sees, since below about 0.9 locks lie elsewhere. The time counts the low-resolution run."
    numbers "Every row" "$table_of_rows"
    numbers "Trainings" "$(for name in "${trainings[@]}"; do
        jq --arg name "$(basename "$name")" --argjson seconds "$(jq .seconds "$name.h5.made")" '{training: $name} + del(.model, .codec, .provenance) + {seconds: $seconds}' "$name.json"
    done | jq -s .)"

    local best quad ratio
    best=$(jq '[.[] | select(.row | startswith("network:")) | ."unseen [mm]"] | min' <<<"$table_of_rows")
    quad=$(jq '.[] | select(.row == "quad interpolation") | ."unseen [mm]"' <<<"$table_of_rows")
    row "error on unseen hair, best network / quad interpolation" "not printed" "$(value "$best / $quad")" 0 0.5 \
        "The paper shows pictures and no error; half of quad interpolation is our own measure of a result worth having"
    if [[ ${#rows_with[@]} == 0 ]]; then return; fi
    row "curl radius of unseen learned hair / the simulation's (strand_mlp)" "curls kept, \"exaggerated\"" \
        "$(jq '.[] | select(.row | startswith("network: strand_mlp")) | ."curl radius"' <<<"$table_of_rows")" 0.9 1.1 "The paper says so of its pictures"
    row "spread of unseen learned tips / the simulation's (strand_mlp)" "clumps as simulated" \
        "$(jq '.[] | select(.row | startswith("network: strand_mlp")) | .tips' <<<"$table_of_rows")" 0.9 1.1 "The paper says so of its pictures"

    picture "$scene" "$scene/unseen/dry_low.h5" "$scene/unseen/wet.h5" "$scene/unseen/tuned.h5" "$scene/unseen/displayed.h5" "$scene/unseen/${papers[0]}@1_paper.h5" \
        --frame $((unseen_frames * 3 / 4))
    # The images that its network reads and makes, on a frame that it did not learn from.
    drawn "${scene}_image" render --image "$scene/pairs_root.h5" "$scene/models/${papers[0]}@1.h5" --frame $((frames - 2))
    # A film of the same, which is not kept in the repository.
    [[ $device != cpu || ${DRAW:-yes} != yes ]] ||
        make "$scene.webm" "$scene/unseen/wet.h5" "$scene/unseen/tuned.h5" -- wetcurl render --width 420 --height 540 \
            "$scene/unseen/dry_low.h5" "$scene/unseen/wet.h5" "$scene/unseen/tuned.h5" -o "$scene.webm"
}
