#!/usr/bin/env bash
# Runs survive: looked at while they are written, killed and resumed to the same bits, on a full disk, cut, refused where
# another run would go on, and begun at a frame of another one.
# Use: test_broken_runs.sh WETCURL PROJECT [KILLS]
# KILLS: at random moments, of all kinds of runs together (default 14).
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/expect.sh"
wetcurl=$(realpath "$1") project=$2 all_kills=${3:-14}
folder=$(mktemp -d)
writer=
trap '[[ -z $writer ]] || kill -KILL "$writer" 2>/dev/null || true; rm -rf "$folder"' EXIT
cd "$folder"
export OMP_WAIT_POLICY=passive XDG_CACHE_HOME=$folder/cache

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}
# Number $2 of the run $1, nothing where it cannot be read.
number() { { "$wetcurl" inspect run "$1" --quiet --json - 2>/dev/null || true; } | sed -n "s/^ *\"$2\": \([0-9]*\).*/\1/p" | head -n 1; }
# All that `inspect run` says of the run $1 but times and what made it.
facts_of() { "$wetcurl" inspect run "$1" --quiet --json - | sed '/seconds/,/[]}]/d; /"provenance"/,/}/d'; }
same() {  # what is claimed, two runs
    facts_of "$2" >a.facts
    facts_of "$3" >b.facts
    grep -q hash a.facts || fail "$1: $2 has no hash"
    cmp -s a.facts b.facts || fail "$1: $2 and $3 differ: $(diff a.facts b.facts | head -n 4)"
}

cat >scene.toml <<'TOML'
frames = 400
[groom]
grid = [6, 6]
particles = 16
length = 0.1
pitch = 0.04
[motion]
axis = [0, 1, 0]
angle = 30
period = 1
[integrator]
substeps = 4
[stretch]
[bend]
[core]
[wetness]
[curl]
[cohesion]
radius = 0.03
[adhesion]
[strand_contact]
[[solid]]
radius = 0.09
attached = "head"
TOML
run="simulate scene.toml --threads 1 --quiet"
"$wetcurl" $run -o alone.h5

# ---- a run under way ----

"$wetcurl" $run --frames 100000 -o way.h5 >said 2>&1 &
writer=$!
until [[ $(number way.h5.partial frames) -gt 2 ]] 2>/dev/null; do kill -0 $writer || break; sleep 0.02; done
before=0
for _ in 1 2 3 4 5; do
    now=$(number way.h5 frames)
    [[ ${now:-0} -ge $before && ${now:-0} -gt 0 ]] || fail "a run under way: $now frames after $before"
    before=${now:-0}
done
expect 0 "is being written by process $writer" "'$wetcurl' inspect run way.h5"
expect 0 '' "'$wetcurl' compare alone.h5 way.h5 --quiet"
expect 0 '' "'$wetcurl' report alone.h5 way.h5 --quiet --json way.json"
if "$wetcurl" --version | grep -q '^features:.*PICTURES'; then expect 0 '' "'$wetcurl' render way.h5 --frame 2 --quiet -o way.png"; fi
expect 0 '' "'$wetcurl' export way.h5 --frames 0 --quiet -o way.ply"
expect 1 "found that process $writer writes it" "'$wetcurl' $run --resume --frames 100000 -o way.h5"
kill -KILL $writer
wait $writer 2>/dev/null || true
writer=
expect 0 'nobody writes it any more' "'$wetcurl' inspect run way.h5"

# ---- killed at random moments (test_broken_runs.cpp kills a writer 200 times) ----

# A ball that is pressed into the hair and swells: ball0.obj, ball1.obj.
for k in 0 1; do
    awk -v k=$k 'BEGIN {
        rows = 12; around = 16; r = 0.05 + 0.03 * k
        for (i = 0; i <= rows; ++i) for (j = 0; j < around; ++j) {
            a = 3.14159265 * i / rows; b = 6.2831853 * j / around
            printf "v %.6f %.6f %.6f\n", r * sin(a) * cos(b) + 0.05, r * cos(a) - 0.05, r * sin(a) * sin(b) + 0.06 - 0.06 * k
        }
        for (i = 0; i < rows; ++i) for (j = 0; j < around; ++j) {
            p = i * around + j + 1; q = i * around + (j + 1) % around + 1
            if (i > 0) print "f", p, q, q + around
            if (i < rows - 1) print "f", p, q + around, p + around
        }
    }' >ball$k.obj
done
cat >body.toml <<'TOML'
frames = 120
[groom]
grid = [6, 6]
particles = 24
length = 0.15
[integrator]
substeps = 4
[stretch]
[bend]
[core]
[stiffness]
[[solid]]
name = "ball"
shape = "mesh"
spacing = 0.01
[[solid.mesh]]
time = 0
file = "ball0.obj"
[[solid.mesh]]
time = 1
file = "ball1.obj"
[motion]
axis = [0, 1, 0]
angle = 20
period = 1
preroll = 0.2
cuts = [60]
TOML

small="--set groom.grid=[6,6] --threads 1 --quiet"
scenes=$project/scenes models=$project/models/weights
"$wetcurl" simulate "$scenes/demo.toml" --set groom.grid=[8,8] --strands 16 --dry --threads 1 --quiet -o low.h5
declare -A runs=(
    [contact]="$run"
    [water]="simulate $scenes/dip.toml $small"
    [air]="simulate $scenes/scene10.toml $small --set air.grid=[16,16,16]"
    [body]="simulate body.toml --threads 1 --quiet"
    [rest]="infer low.h5 --interpolate rest --threads 1 --quiet"
)
if "$wetcurl" inspect model "$models/strand_m.h5" --json - >/dev/null 2>&1; then
    runs[adhesion_network]="infer $scenes/scene15.toml --frames 40 $small"
    runs[strand_network]="infer low.h5 --model $models/strand_m.h5 --threads 1 --quiet"
    runs[locks]="infer low.h5 --model $models/displayed_s.h5 --locks 7 --threads 1 --quiet"
fi

RANDOM=7
all=0 all_broken=0
for name in "${!runs[@]}"; do
    command=${runs[$name]} kills=0 frames=0 broken=0
    begin=$(date +%s%3N)
    "$wetcurl" $command -o whole.h5 >said 2>&1 || fail "$name: $(<said)"
    longest=$(($(date +%s%3N) - begin))
    # Until one has left a frame too: on a machine that is busy just now, many come before the first.
    for ((tries = 0; (kills < (all_kills + ${#runs[@]} - 1) / ${#runs[@]} || broken == 0) && tries < 8 * all_kills; ++tries)); do
        "$wetcurl" $command -o killed.h5 --resume >said 2>&1 &
        writer=$!
        moment=$(((RANDOM * 32768 + RANDOM) % longest))
        sleep "$((moment / 1000)).$(printf %03d $((moment % 1000)))"
        kill -KILL $writer 2>/dev/null && kills=$((kills + 1))
        status=0
        wait $writer 2>/dev/null || status=$?
        writer=
        [[ $status == 0 || $status == 137 ]] || fail "$name, kill $kills: status $status: $(<said)"
        if [[ -e killed.h5 ]]; then
            same "$name, after $kills kills" whole.h5 killed.h5
            rm -f killed.h5*
            frames=0
        elif [[ -s killed.h5.partial ]]; then
            now=$(number killed.h5.partial frames)
            [[ ${now:-0} -ge $frames ]] || fail "$name, kill $kills: $frames frames became ${now:-none}"
            frames=${now:-0}
            broken=$((broken + (frames > 0)))
        fi
    done
    "$wetcurl" $command -o killed.h5 --resume >said 2>&1 || fail "$name: $(<said)"
    same "$name, after $kills kills" whole.h5 killed.h5
    [[ ! -e killed.h5.state && ! -e killed.h5.partial ]] || fail "$name: left behind: $(ls killed.h5.*)"
    rm -f killed.h5* whole.h5
    echo "$name: $kills kills within $longest ms, $broken of them with frames"
    all=$((all + kills)) all_broken=$((all_broken + broken))
done
((all >= all_kills && all_broken >= ${#runs[@]})) || fail "only $all kills, of which only $all_broken left a frame"
cp alone.h5 killed.h5
expect 0 'is complete, nothing to resume' "'$wetcurl' simulate scene.toml --threads 1 -o killed.h5 --resume"

expect 1 "now it is 'stiffness = 60" "'$wetcurl' simulate scene.toml --threads 1 -o killed.h5 --resume --set stretch.stiffness=60 --quiet"
expect 1 "'frames = 400', now it is 'frames = 20'" "'$wetcurl' simulate scene.toml --threads 1 -o killed.h5 --resume --frames 20"

# ---- a full disk, then room; a signal; another run in its place ----

(trap '' XFSZ; ulimit -f 3000; "$wetcurl" $run -o full.h5 >said 2>&1) && fail 'a full disk is no error'
grep -q 'disk full?' said || fail "a full disk: $(<said)"
[[ $(number full.h5.partial frames) -gt 3 ]] || fail "a full disk left $(number full.h5.partial frames) frames"
cp full.h5.partial other.h5.partial
cp full.h5.state other.h5.state
expect 0 '' "'$wetcurl' $run -o full.h5 --resume"
same 'a run that found a full disk' alone.h5 full.h5
expect 1 "has scene [motion] 'period = 1', now it is 'period = 2.0'" "'$wetcurl' $run --set motion.period=2.0 -o other.h5 --resume"
expect 1 'the state is of precision float, now it is double' "'$wetcurl' $run --precision double -o other.h5 --resume"
cp other.h5.partial cut.h5.partial
truncate -s -9000 cut.h5.partial
expect 0 '' "'$wetcurl' inspect run cut.h5.partial"
truncate -s $(($(stat -c %s cut.h5.partial) * 6 / 10)) cut.h5.partial
expect 1 'whose end is missing' "'$wetcurl' inspect run cut.h5.partial"
rm other.h5.state
expect 0 'without a state in other.h5.state all frames are computed again' "'$wetcurl' simulate scene.toml --threads 1 -o other.h5 --resume"
same 'a run without its state' alone.h5 other.h5

# Begun again where it ended before three frames were seen, as happens on a busy machine.
for ((tries = 0; tries < 20; ++tries)); do
    rm -f stopped.h5*
    "$wetcurl" $run -o stopped.h5 >said 2>&1 &
    writer=$!
    until [[ $(number stopped.h5.partial frames) -gt 2 ]] 2>/dev/null; do
        kill -0 $writer 2>/dev/null || break
        sleep 0.02
    done
    kill -TERM $writer 2>/dev/null || true
    status=0
    wait $writer || status=$?
    writer=
    [[ $status == 0 ]] || break
done
[[ $status == 130 && $(<said) == *'--resume goes on'* ]] || fail "a signal: $status: $(<said)"
"$wetcurl" $run -o stopped.h5 --resume
same 'a run that was stopped' alone.h5 stopped.h5

# ---- every kind of scene that is shipped ----

for scene in "$project"/scenes/*.toml; do
    [[ $scene != *_recipe.toml ]] || continue
    name=$(basename "$scene" .toml)
    small="simulate $scene --frames 6 --set groom.grid=[6,6] --set integrator.settle=0 --threads 1 --quiet"
    "$wetcurl" $small -o whole.h5 --overwrite
    half=$(($(stat -c %s whole.h5) / 1024 * 6 / 10))
    (trap '' XFSZ; ulimit -f "$half"; "$wetcurl" $small -o broken.h5 >said 2>&1) && fail "$name: not broken"
    "$wetcurl" $small -o broken.h5 --resume
    same "scene $name" whole.h5 broken.h5
    rm -f broken.h5* whole.h5*
done

# ---- from a frame of another run ----

"$wetcurl" $run --frames 20 -o first.h5 --keep-state
"$wetcurl" $run --frames 381 -o second.h5 --from first.h5@19
"$wetcurl" simulate scene.toml --frames 4 --threads 1 --set motion.angle=0 -o third.h5 --from first.h5@5 2>said
grep -q 'velocities by the difference' said || fail "--from: $(<said)"
[[ $("$wetcurl" inspect run second.h5 --json - --quiet | sed -n 's/^ *"hash": "\(.*\)".*/\1/p') != "" ]] || fail '--from: no hash'
"$wetcurl" inspect run alone.h5 --quiet --json - | grep '"sum"' | tail -n 380 >a.facts
"$wetcurl" inspect run second.h5 --quiet --json - | grep '"sum"' | tail -n 380 >b.facts
cmp -s a.facts b.facts || fail "--from with a state: energies differ: $(diff a.facts b.facts | head -n 2)"
expect 1 'has 36 strands of 16 particles, the scene 9 of 16' "'$wetcurl' $run --frames 4 --strands 16 -o fourth.h5 --from first.h5@5"
expect 2 'found frame 20, allowed 0 to 19' "'$wetcurl' $run --frames 4 -o fourth.h5 --from first.h5@20"
exit $((failures > 0))
