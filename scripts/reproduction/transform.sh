# Eq 18, 19: how much the nonlinear quad transform can move and gain, whatever its network predicts
# also: eq18
#
# Eq 18 moves each particle of a new strand toward those of its four neighbours, with one weight a neighbour and strand,
# never negative: that is all that colours decide. Measured here, from dry and from wet low-resolution runs: no network
# (weights 0); the colours of the paper's networks, trained here; the colours of the wet run itself, which a network
# without error predicts; and the best weights of all, a bound for any colours, gain and units.

every_gain=(1 3.16 10 31.6 100 316 1000) # half decades, so that the chart's axis is their logarithm
gains=("${every_gain[@]}")
forms=(paper core) inputs=(dry_low wet_low)

# transformed OUTPUT FOLDER INPUT OPTION...: OUTPUT, what `compare` says of the strands that `infer` makes, which are not kept.
transformed() {
    local output=$1 folder=$2 input=$3
    shift 3
    wetcurl infer "$folder/$input.h5" "$@" -o "$folder/transformed.h5" --json "$folder/transformed.json"
    wetcurl compare "$folder/wet.h5" "$folder/transformed.h5" --first-frame "$first" --json "$folder/compared.json"
    jq -n --slurpfile i "$folder/transformed.json" --slurpfile c "$folder/compared.json" '$c[0].others[0] |
        {method, error_mm: .position_mm.mean, tips: .tip_spread_ratio, curl_radius: .curl_radius_ratio,
         moved_mm: ($i[0] | .moved_by_oracle_mm // .moved_by_network_mm // 0)}' >"$output"
    rm "$folder/transformed.h5" "$folder/transformed.json" "$folder/compared.json"
}
# measured NAME FOLDER INPUT OPTION...: FOLDER/NAME.json, in out/reproduction/transform
measured() {
    local name=$1 folder=transform/$2 input=$3 word sources=()
    shift 3
    for word in "$@"; do [[ $word != *.h5 ]] || sources+=("$word"); done
    make "$folder/$name.json" "$folder/$input.h5" "$folder/wet.h5" "${sources[@]}" -- transformed "$folder/$name.json" "$folder" "$input" "$@"
}
# swept FOLDER INPUT FORM COLOURS OPTION...: at every gain
swept() {
    local folder=$1 input=$2 form=$3 colours=$4 gain
    shift 4
    for gain in "${gains[@]}"; do measured "$input.$form.$colours.$gain" "$folder" "$input" --reconstruct "$form" --gain "$gain" "$@"; done
}
# runs_in FOLDER SCENE LOW_STRANDS OPTION...
runs_in() {
    # Edges of any length: how far a transform throws strands is what is asked.
    local folder=transform/$1 scene=$2 low=$3 any=(--set integrator.allow_stretch=1e9)
    shift 3
    simulate "$folder/wet" "$scene" "$@"
    simulate "$folder/dry_low" "$scene" --dry --strands "$low" "${any[@]}" "$@"
    simulate "$folder/wet_low" "$scene" --strands "$low" --before-cohesion "${any[@]}" "$@"
}
# oracles_in FOLDER: all that needs no network
oracles_in() {
    local folder=$1 input form
    for input in "${inputs[@]}"; do
        for form in "${forms[@]}"; do
            measured "$input.$form.none" "$folder" "$input" --interpolate "$([[ $form == paper ]] && echo quad || echo core)"
            measured "$input.$form.bound" "$folder" "$input" --reconstruct "$form" --oracle-weights "transform/$folder/wet.h5"
            swept "$folder" "$input" "$form" oracle --oracle-colours "transform/$folder/wet.h5"
        done
    done
}

# Scenes: half of the demo, whose last quarter no training sees; Fig 34's loose waves; curls as of the data sets' test.
first=36
runs_in demo scenes/demo.toml 256 --frames 48
oracles_in demo
networks=(unet_vgg19 recursive_residual)
for input in "${inputs[@]}"; do
    pairs=transform/demo/$input.pairs.h5
    make "$pairs" "transform/demo/$input.h5" transform/demo/wet.h5 -- wetcurl encode "transform/demo/$input.h5" transform/demo/wet.h5 --codec root -o "$pairs"
    for network in "${networks[@]}"; do
        model=transform/demo/$input.$network.h5
        make "$model" "$pairs" -- wetcurl train sr "$pairs" -o "$model" --json "$model.json" --arch "$network" --width 0.25 \
            --set validation=0.25 --set validate_every=1000000 --set batch=8 --set learning_rate=1e-3 --set schedule=cosine --set epochs=30
        swept demo "$input" paper "$network" --model "$model"
    done
done
# Eq 16 and 18 as they are printed, SI numbers. With a gain of 1 strands leave the planet, which infer refuses.
measured dry_low.paper.printed.0.001 demo dry_low --reconstruct paper --oracle-colours transform/demo/wet.h5 --units printed --gain 0.001
for gain in 1 10 100; do
    measured "dry_low.paper.printed_colours.$gain" demo dry_low --reconstruct paper --oracle-colours transform/demo/wet.h5 --colour-units printed --gain "$gain"
done
first=16 gains=(1 10 100)
runs_in waves scenes/scene12.toml 128 --frames 32
oracles_in waves
runs_in curls scenes/dataset/base.toml 256 --frames 32 --seed 5 --set groom.length=0.32 --set groom.curl_radius=0.01 \
    --set groom.pitch=0.03 --set groom.phase_noise=3 --set wetness.level=0.8 --set 'motion.axis=[1,0,0]' --set motion.angle=15 --set motion.period=1.4
oracles_in curls

# all_of FOLDER: a JSON list of what was measured there, names apart: {input, form, colours, gain, ...}
all_of() {
    local file name
    for file in transform/"$1"/*_low.*.*.json; do
        [[ $file != *.h5.json && $file != *.inspect.json ]] || continue
        name=$(basename "$file" .json)
        jq --arg name "$name" '($name | split(".")) as [$input, $form, $colours] |
            {$input, $form, $colours, gain: ($name | split(".")[3:] | join(".") | if . == "" then null else tonumber end)} + .' "$file"
    done | jq -s .
}
declare -A all
for folder in demo waves curls; do all[$folder]=$(all_of "$folder"); done
declare -A title=([demo]="the demo, last quarter" [waves]="Fig 34's loose waves" [curls]="long curls" [dry_low]="a dry run" [wet_low]="a wet low-resolution run"
    [paper]="quad" [core]="core and detail")

# The best gain of each kind of colours, beside no network and the bound.
declare -A words=([none]="no network" [oracle]="true colours" [unet_vgg19]="unet_vgg19" [recursive_residual]="recursive_residual" [bound]="best weights: the bound")
names=$(for key in "${!words[@]}"; do jq -n --arg key "$key" --arg word "${words[$key]}" '{($key): $word}'; done | jq -s add)
for folder in demo waves curls; do
    for input in "${inputs[@]}"; do
        numbers "${title[$folder]^}, from ${title[$input]}, each at its best gain" "$(jq --argjson names "$names" --arg input "$input" '
            [["paper", "core"][] as $form | ["none", "unet_vgg19", "recursive_residual", "oracle", "bound"][] as $colours |
             ([.[] | select(.input == $input and .form == $form and .colours == $colours)] | sort_by(.error_mm)[0] // empty) |
             {"p*": (if $form == "paper" then "quad" else "core and detail" end), colours: $names[$colours], gain: (.gain // "-"),
              "error [mm]": .error_mm, "moved [mm]": .moved_mm, tips, "curl radius": .curl_radius}]' <<<"${all[$folder]}")"
    done
done
numbers "True colours of the demo from a dry run, quad: every gain" "$(jq '[.[] | select(.input == "dry_low" and .form == "paper" and .colours == "oracle")] | sort_by(.gain) |
    map({gain, "error [mm]": .error_mm, "moved [mm]": .moved_mm, tips, "curl radius": .curl_radius})' <<<"${all[demo]}")"
numbers "The same as printed, SI numbers" "$(jq '[.[] | select(.colours | startswith("printed"))] | sort_by(.colours, .gain) |
    map({reading: (if .colours == "printed" then "Eq 18 as printed, gain \(.gain)" else "Eq 16 as printed, gain \(.gain)" end), "error [mm]": .error_mm, "moved [mm]": .moved_mm, tips, "curl radius": .curl_radius})' <<<"${all[demo]}")"

# best FOLDER INPUT FORM COLOURS KEY: of the gain with the least error
best() {
    jq --arg input "$2" --arg form "$3" --arg colours "$4" --arg key "$5" \
        '[.[] | select(.input == $input and .form == $form and .colours == $colours)] | sort_by(.error_mm)[0][$key]' <<<"${all[$1]}"
}
for folder in demo waves curls; do
    for input in "${inputs[@]}"; do
        none=$(best $folder "$input" paper none error_mm) oracle=$(best $folder "$input" paper oracle error_mm) bound=$(best $folder "$input" paper bound error_mm)
        row "${title[$folder]}, from ${title[$input]}: error with the true colours / with no network" "not printed" "$(value "$oracle / $none")" 0 0.5 \
            "Half is our own measure of a network that makes the result. $(short "$none") mm without, $(short "$oracle") mm at the best gain, $(best $folder "$input" paper oracle gain)"
        row "${title[$folder]}, from ${title[$input]}: error with the best weights / with no network" "not printed" "$(value "$bound / $none")" 0 0.5 \
            "No colours, gain or units do better than $(short "$bound") mm"
    done
done

# gained COLOURS INPUT: the share of the error that these colours remove, at their best gain, over the scenes
gained() {
    local folder
    for folder in demo waves curls; do
        value "100 * (1 - $(best $folder "$2" paper "$1" error_mm) / $(best $folder "$2" paper none error_mm))"
        echo
    done | sort -g | awk '{ v[NR] = sprintf("%.1f", $1 < 0 ? 0 : $1) } END { print v[1] == v[NR] ? v[1] " %" : v[1] " to " v[NR] " %" }'
}
# by_network NAME: that share for a network on the demo, from the dry run
by_network() {
    awk -v e="$(best demo dry_low paper "$1" error_mm)" -v n="$(best demo dry_low paper none error_mm)" 'BEGIN { printf "%.1f %%", 100 * (1 - e / n) }'
}
note "Eq 18 draws a new strand toward its four neighbours, with one weight for each of them along the whole strand. It cannot push, turn or curl a strand, and it moves nothing beyond the support radius. So the colours decide little. From a dry run the true colours, at their best gain, remove $(gained oracle dry_low) of the error of plain interpolation, and no colours could remove more than $(gained bound dry_low). From a wet low-resolution run it is $(gained oracle wet_low), and at most $(gained bound wet_low)."
note "The trained networks remove $(by_network unet_vgg19) (unet_vgg19) and $(by_network recursive_residual) (recursive_residual) of it on the demo from a dry run, each at its best gain. With a larger gain strands are thrown past their neighbours: the error, the spread of tips and the curl radius grow. As printed, in SI numbers, Eq 18 moves a particle by $(jq '.moved_mm / 0.001 / 1e6 | round' transform/demo/dry_low.paper.printed.0.001.json) km."
note "So nearly all of what the paper shows as learned wet hair must come from the strands that Eq 18 interpolates, or from another transform than the printed one. The clumps do not come from it either: on the demo from a dry run, no gain of the true colours brings the tips closer together than $(jq '[.[] | select(.input == "dry_low" and .form == "paper" and .colours == "oracle") | .tips] | min | . * 100 | round / 100' <<<"${all[demo]}") times as far apart as the simulation's."

# chart_of INPUT: a line for each kind of colours; it ends where strands clump to more than half again the error.
chart_of() {
    jq --argjson names '{"none": "no network", "unet_vgg19": "unet_vgg19", "recursive_residual": "residual", "oracle": "true", "bound": "bound"}' \
        --arg input "$1" --arg title "from ${title[$1]}" --argjson gains "$(printf '%s\n' "${every_gain[@]}" | jq -s .)" '
        [.[] | select(.input == $input and .form == "paper")] as $all | ($all[] | select(.colours == "none") | .error_mm) as $none |
        {$title, x_label: "log10 of the gain", y_label: "error [mm]", dx: 0.5, curves: [
         ["none", "unet_vgg19", "recursive_residual", "oracle", "bound"][] as $colours | {name: $names[$colours], values:
          [$gains[] as $g | [$all[] | select(.colours == $colours and (.gain == null or .gain == $g))][0].error_mm | if . > 1.5 * $none then null else . end]}]}' <<<"${all[demo]}"
}
for input in "${inputs[@]}"; do chart_of "$input" >"transform/$input.chart.json"; done
note "In the picture a line ends before the gain at which the error passes 1.5 times that of no network."
chart transform transform/dry_low.chart.json transform/wet_low.chart.json
