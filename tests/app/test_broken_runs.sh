#!/usr/bin/env bash
# Runs survive: looked at while they are written, killed and resumed to the same bits, on a full disk, cut, refused where
# another run would go on, and begun at a frame of another one.
# Use: test_broken_runs.sh WETCURL PROJECT
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/expect.sh"
wetcurl=$(realpath "$1") project=$2
folder=$(mktemp -d)
writer=
trap '[[ -z $writer ]] || kill -KILL "$writer" 2>/dev/null || true; rm -rf "$folder"' EXIT
cd "$folder"
export OMP_WAIT_POLICY=passive XDG_CACHE_HOME=$folder/cache

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}
# Number $2 of the run $1, 0 where it cannot be read.
number() { "$wetcurl" inspect run "$1" --quiet --json - 2>/dev/null | sed -n "s/^ *\"$2\": \([0-9]*\).*/\1/p" | head -n 1; }
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
expect 1 "found that process $writer writes it" "'$wetcurl' $run --resume --frames 100000 -o way.h5"
kill -KILL $writer
wait $writer 2>/dev/null || true
writer=
expect 0 'nobody writes it any more' "'$wetcurl' inspect run way.h5"

# ---- killed again and again (test_broken_runs.cpp kills a writer 200 times) ----

RANDOM=7
kills=0 frames=0
for _ in {1..60}; do
    "$wetcurl" $run -o killed.h5 --resume >said 2>&1 &
    writer=$!
    sleep "0.$((RANDOM % 300 + 100))"
    kill -KILL $writer 2>/dev/null && kills=$((kills + 1))
    wait $writer 2>/dev/null || true
    writer=
    [[ ! -e killed.h5 ]] || break
    if ((kills % 10 == 0)) && [[ -s killed.h5.partial ]]; then
        now=$(number killed.h5.partial frames)
        [[ ${now:-0} -ge $frames ]] || fail "kill $kills: $frames frames became ${now:-none}"
        frames=${now:-0}
    fi
done
echo "$kills kills, $frames frames were there before the last one"
((kills > 20)) || fail "only $kills kills"
[[ -e killed.h5 ]] || "$wetcurl" $run -o killed.h5 --resume
same 'a run that was killed again and again' alone.h5 killed.h5
[[ ! -e killed.h5.state && ! -e killed.h5.partial ]] || fail "left behind: $(ls killed.h5.*)"
expect 0 'is complete, nothing to resume' "'$wetcurl' simulate scene.toml --threads 1 -o killed.h5 --resume"

# ---- a full disk, then room; a signal; another run in its place ----

(trap '' XFSZ; ulimit -f 3000; "$wetcurl" $run -o full.h5 >said 2>&1) && fail 'a full disk is no error'
grep -q 'disk full?' said || fail "a full disk: $(<said)"
[[ $(number full.h5.partial frames) -gt 3 ]] || fail "a full disk left $(number full.h5.partial frames) frames"
cp full.h5.partial other.h5.partial
cp full.h5.state other.h5.state
expect 0 '' "'$wetcurl' $run -o full.h5 --resume"
same 'a run that found a full disk' alone.h5 full.h5
expect 1 "has scene 'period = 1', now it is 'period = 2.0'" "'$wetcurl' $run --set motion.period=2.0 -o other.h5 --resume"
expect 1 'the state is of precision float, now it is double' "'$wetcurl' $run --precision double -o other.h5 --resume"
truncate -s -9000 other.h5.partial
expect 0 '' "'$wetcurl' inspect run other.h5.partial"
rm other.h5.state
expect 0 'without other.h5.state all frames are computed again' "'$wetcurl' simulate scene.toml --threads 1 -o other.h5 --resume"
same 'a run that was cut, without its state' alone.h5 other.h5

"$wetcurl" $run -o stopped.h5 >said 2>&1 &
writer=$!
until [[ $(number stopped.h5.partial frames) -gt 2 ]] 2>/dev/null; do kill -0 $writer || break; sleep 0.02; done
kill -TERM $writer
status=0
wait $writer || status=$?
writer=
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

# ---- infer ----

"$wetcurl" simulate scene.toml --frames 60 --strands 16 --dry --threads 1 --quiet -o low.h5
infer="infer low.h5 --interpolate rest --threads 1 --quiet"
"$wetcurl" $infer -o learned.h5
(trap '' XFSZ; ulimit -f $(($(stat -c %s learned.h5) / 2048)); "$wetcurl" $infer -o again.h5 >said 2>&1) && fail 'infer: not broken'
"$wetcurl" $infer -o again.h5 --resume
same 'an inferred run' learned.h5 again.h5

# ---- from a frame of another run ----

"$wetcurl" $run --frames 20 -o first.h5 --keep-state
"$wetcurl" $run --frames 381 -o second.h5 --from first.h5@19
"$wetcurl" simulate scene.toml --frames 4 --threads 1 --set motion.angle=0 -o third.h5 --from first.h5@5 2>said
grep -q 'velocities by the difference' said || fail "--from: $(<said)"
[[ $("$wetcurl" inspect run second.h5 --json - --quiet | sed -n 's/^ *"hash": "\(.*\)".*/\1/p') != "" ]] || fail '--from: no hash'
"$wetcurl" inspect run alone.h5 --quiet --json - | grep '"sum"' | tail -n 380 >a.facts
"$wetcurl" inspect run second.h5 --quiet --json - | grep '"sum"' | tail -n 380 >b.facts
cmp -s a.facts b.facts || fail "--from with a state: energies differ: $(diff a.facts b.facts | head -n 2)"
expect 1 'has 36 strands of 16 particles, the scene 16 of 16' "'$wetcurl' $run --frames 4 --strands 16 -o fourth.h5 --from first.h5@5"
expect 2 'found frame 20, allowed 0 to 19' "'$wetcurl' $run --frames 4 -o fourth.h5 --from first.h5@20"
exit $((failures > 0))
