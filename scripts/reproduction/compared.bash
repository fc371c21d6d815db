# The compared methods (Fig 2 to 5, 9 to 12, 23 and Table 6): what their items share.
#
# trial RUN SCENE OPTION...        as `simulate`, for a run that may diverge: RUN.h5 then ends where it did
# beside NAME REFERENCE RUN...     as `compared`; jitter RUN, spread RUN and curl_kept RUN are then of it: [mm] on a still
#                                  head; the distance of tips, and the radius of curls, over those of REFERENCE
# trembling_of NAME DRY RUN...     rows and a table: the jitter of each run on a still head
# clumping_of NAME DRY RUN...      a table: spread of tips, curl, and whether the run is whole
# whole RUN WHAT                   a line judged by whether the run reached its end, which the paper's did not
# last_of RUN...                   the last frame that all of them have

trial_run() {
    local run=$1
    shift
    wetcurl simulate "$@" -o "$run.h5" --json "$run.json" && return
    [[ $(jq .diverged "$run.json") == true ]] || return 1
    mv "$run.h5.partial" "$run.h5"
}
trial() {
    local run=$1 scene=$2
    shift 2
    [[ $scene != scenes/* ]] || scene=$root/$scene
    [[ -z ${FRAMES:-} || " $* " == *" --frames "* ]] || set -- "$@" --frames "$FRAMES"
    make "$run.h5" "$scene" -- trial_run "$run" "$scene" --device "$device" "$@"
}

beside() {
    comparison=$1
    compared "$@"
}
metric() { jq "[.others[] | select(.file | endswith(\"$1.h5\"))][0]$2" "$comparison.json"; }
jitter() { metric "$1" .jitter_mm; }
spread() { metric "$1" .tip_spread_ratio; }
curl_kept() { metric "$1" .curl_radius_ratio; }
method_of() { metric "$1" .method | jq -r 'sub("^simulated wet, "; "") | sub("^simulated wet$"; "ours")'; }
said() { sed -n "s/^$2 = //p" "$root/scenes/$1.toml"; }  # SCENE KEY: what the scene file says
whole_run() { jq -r 'if .diverged then "diverged after \(.frames) frames" else "yes" end' "$1.json"; }
last_of() { for run in "$@"; do jq .frames "$run.json"; done | sort -n | head -n 1 | jq '. - 1'; }

# A wet force is to blame for what it adds to the noise of Iben's chain alone, which has no row of its own.
calm=0.05  # [mm] of jitter, 1 % of a segment
trembling_of() {
    local name=$1 dry=$2 run noise alone= rows=()
    shift 2
    first_frame=$(frame 4) beside "$name" "$dry" "$@"
    for run in "$@"; do [[ $run != *iben* ]] || alone=$(jitter "$run"); done
    for run in "$@"; do
        noise=$(jitter "$run")
        rows+=("$(jq -nc --arg method "$(method_of "$run")" --argjson noise "$noise" --argjson spread "$(spread "$run")" \
            --argjson curl "$(curl_kept "$run")" --arg whole "$(whole_run "$run")" \
            '{$method, "jitter [mm]": $noise, "spread of tips, wet / dry": $spread, "radius of curls, wet / dry": $curl, "whole run": $whole}')")
        [[ $run != *iben* ]] || continue
        local low=$calm high=1e12 paper="noisy, trembling"
        [[ $run != *ours* ]] || low=0 high=$calm paper="stable"
        [[ $noise != null ]] || noise=1e12
        row "jitter on a still head [mm], $(method_of "$run")" "$paper" "$noise" $low "$high" \
            "root mean square third difference over frames; calm is below $calm, 1 % of a segment"
        [[ -z $alone || $run == *ours* ]] || row "the same over that of Iben's chain alone, $(method_of "$run")" "above 1: the paper blames the wet force" \
            "$(value "$noise / $alone")" 1.2 1e12 "agrees from 1.2. The chain alone trembles by $(short "$alone") mm: as printed, Eq 4 and 5 push particles without a reaction, and feed energy in"
    done
    numbers "On a still head" "$(printf '%s\n' "${rows[@]}" | jq -sc .)"
    [[ " $* " != *lin* && " $* " != *kim* ]] || note "On Iben's chain Lin's force has the strength $(said compare_lin_iben strength), Kim's $(said compare_kim_iben strength) and for the area $(said compare_kim_iben area): the keys of [baseline] in scenes/compare_lin_iben.toml and compare_kim_iben.toml, where the choice is explained."
}
clumping_of() {
    local name=$1 dry=$2 run rows=()
    shift 2
    first_frame=$(frame 12) beside "$name" "$dry" "$@"
    for run in "$@"; do
        rows+=("$(jq -nc --arg method "$(method_of "$run")" --argjson spread "$(spread "$run")" --argjson curl "$(curl_kept "$run")" \
            --arg whole "$(whole_run "$run")" '{$method, "spread of tips, wet / dry": $spread, "radius of curls, wet / dry": $curl, "whole run": $whole}')")
    done
    numbers "On a head that moves" "$(printf '%s\n' "${rows[@]}" | jq -sc .)"
}
whole() {
    local verdict=no
    [[ $(whole_run "$1") == yes ]] || verdict=yes
    seen "whether the run by $(method_of "$1") reaches its end" "$2" "$(whole_run "$1")" $verdict "whole: all positions are finite and within ten strand lengths of their roots. At these strengths noise stays bounded here; Table 6 shows how it grows with them"
}

# Iben's chain takes 400 steps a frame, in each of which wet forces seek their neighbours: figures on it show 144 strands,
# after half a second of settling.
few=(--set 'groom.grid=[12, 12]' --set integrator.settle=0.5)
still=(--set motion.angle=0 --frames "$(frames 16)")

# Short hair at low resolution: dry, and Iben's chain alone, which tells how much of the noise is the wet force's.
short_low_hair() {
    simulate short_dry scenes/compare_short.toml --dry "${still[@]}" "${few[@]}" --set integrator.settle=2
    trial short_iben scenes/compare_iben.toml "${still[@]}" --set groom.length=0.12 --set groom.particles=26 --set groom.lift=0.012 "${few[@]}"
}
# long_still ours|lin|kim: long hair on a still head, dry and by the method; beside Lin and Kim, by Iben's chain alone.
long_still() {
    if [[ $1 == ours ]]; then
        simulate long_dry_still scenes/compare_head.toml --dry --set motion.angle=0 --set integrator.settle=3 --frames "$(frames 24)"
        simulate long_ours_still scenes/compare_ours.toml --set motion.angle=0 --set integrator.settle=3 --frames "$(frames 24)"
    else
        simulate few_dry_still scenes/compare_head.toml --dry "${still[@]}" "${few[@]}" --set integrator.settle=3
        trial few_iben_still scenes/compare_iben.toml "${still[@]}" "${few[@]}"
        trial "few_$1_still" "scenes/compare_$1_iben.toml" "${still[@]}" "${few[@]}"
    fi
}
# few_turned lin|kim: the same on a head that turns, and dry.
few_turned() {
    simulate few_dry_turned scenes/compare_head.toml --dry "${few[@]}" --frames "$(frames 28)"
    trial "few_$1_turned" "scenes/compare_$1_iben.toml" "${few[@]}" --frames "$(frames 28)"
}
