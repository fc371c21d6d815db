#!/usr/bin/env bash
# Two processes on one output, for each kind of output: the second is refused and says why, the first one's file is
# what it would be alone. What is no file is refused, links are followed, what a killed process left is no obstacle,
# and a signal that comes twice at once does not cost what it asks to keep.
# Use: test_two_writers.sh WETCURL
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/expect.sh"
wetcurl=$1
folder=$(mktemp -d)
first=
trap '[[ -z $first ]] || kill -KILL "$first" 2>/dev/null || true; rm -rf "$folder"' EXIT
cd "$folder"
export XDG_CACHE_HOME=$folder/cache OMP_WAIT_POLICY=passive

fail() {
    echo "FAILED: $*"
    failures=$((failures + 1))
}
check() {  # what is claimed, a command
    local claim=$1
    shift
    "$@" >/dev/null 2>&1 || fail "$claim: $*"
}

# ---- small inputs of every kind ----

cat >scene.toml <<'TOML'
frames = 4
[groom]
grid = [8, 8]
particles = 25
length = 0.1
pitch = 0.04
[integrator]
substeps = 4
[stretch]
[bend]
[core]
[wetness]
[curl]
[cohesion]
radius = 0.03
TOML
cat >recipe.toml <<'TOML'
scene = "base.toml"
first = 1
[splits]
train = 3
validation = 1
test = 0
[draw]
"groom.length" = [0.08, 0.12]
[[pick.wetness]]
name = "uniform"
text = '[wetness]'
TOML
sed '/^\[wetness\]/d; s/^frames = 4/frames = 40/' scene.toml >base.toml
quiet="--threads 1 --quiet"
"$wetcurl" simulate scene.toml --strands 16 --dry $quiet -o low.h5
"$wetcurl" simulate scene.toml $quiet -o wet.h5
"$wetcurl" infer low.h5 --interpolate quad $quiet -o quad.h5
"$wetcurl" encode low.h5 wet.h5 $quiet -o pairs.h5
# Two strands of two points: counts, then (0, 0, 0) (0, 0.1, 0) and (0.1, 0, 0) (0.1, 0.1, 0).
nought='\0\0\0\0' tenth='\xcd\xcc\xcc\x3d'
printf "\2\0\0\0\2\0\0\0$nought$nought$nought$nought$tenth$nought\2\0\0\0$tenth$nought$nought$tenth$tenth$nought" >two.data
pictures=1
"$wetcurl" plot wet.h5 $quiet -o probe.png 2>said || { grep -q OpenCV said && pictures=0; }
networks=1
"$wetcurl" train sr pairs.h5 $quiet --set epochs=1 --set width=0.1 -o probe.h5 >said 2>&1 || networks=0

# ---- every kind: a lock held elsewhere, a pipe, a link with something stale beside its target ----

# Name of the partial file of $1.
partial_of() { case $1 in *.webm) echo "${1%.webm}.partial.webm" ;; *) echo "$1.partial" ;; esac; }

aside=()  # other files that the next command makes
each() {  # file, whether a pipe may stand there (stream | file), the command without its name, OUT for the file
    local out=$1 may=$2 command="rm -f ${aside[*]}; '$wetcurl' ${*:3}" partial
    partial=$(partial_of "$out")
    command=${command//OUT/$out}
    # Another process writes it.
    exec 9>>"$partial"
    flock 9
    printf theirs >&9
    expect 1 "$out: found that another process writes it, allowed is one process at a time; wait until it ends" "$command"
    [[ $(<"$partial") == theirs && ! -e $out ]] || fail "$out: what another process writes was touched"
    exec 9>&-
    # It ended without renaming it, and the name is a link to a file in another folder.
    mkdir -p there
    ln -s "there/real_$out" "$out"
    mv "$partial" "$(partial_of "there/real_$out")"
    expect 0 '' "$command"
    [[ -L $out && -s there/real_$out && ! -e $(partial_of "there/real_$out") ]] ||
        fail "$out: the link was not followed: $(ls -l . there)"
    expect 1 "$out: is there already; --overwrite replaces it" "$command"
    expect 0 '' "$command --overwrite"
    [[ -L $out && -s there/real_$out ]] || fail "$out: the link was replaced"
    rm -r "$out" there
    if [[ $may == file ]]; then
        mkfifo "$out"
        expect 1 "$out: found a pipe, allowed is the name of a file" "$command --overwrite"
        [[ -p $out ]] || fail "$out: the pipe was replaced"
        rm "$out"
    fi
}

each run.h5 file simulate scene.toml --strands 16 $quiet -o OUT
aside=(aside.h5)
each run.json stream simulate scene.toml --strands 16 $quiet -o aside.h5 --json OUT
each learned.h5 file infer low.h5 --interpolate rest $quiet -o OUT
each made.h5 file encode low.h5 wet.h5 $quiet -o OUT
each made.json stream encode low.h5 wet.h5 $quiet -o aside.h5 --json OUT
each hair.hair file import two.data OUT --units m $quiet
each hair.data file import two.data OUT --units m $quiet
each hair.json stream import two.data --units m $quiet --json OUT
each compared.json stream compare wet.h5 quad.h5 $quiet --json OUT
each page.html file report wet.h5 quad.h5 $quiet -o OUT
each page.json stream report wet.h5 quad.h5 $quiet --json OUT
each inspected.json stream inspect run wet.h5 $quiet --json OUT
each bench.json stream bench --filter "'level set build 16'" $quiet --json OUT
each stability.json stream stability --case S1 --quick --method ours $quiet --json OUT
if ((pictures)); then
    each picture.png file render wet.h5 --width 32 --height 32 $quiet -o OUT
    each film.webm file render wet.h5 --width 32 --height 32 $quiet -o OUT
    each energy.png file plot wet.h5 $quiet -o OUT
    each images.png file render --image pairs.h5 $quiet -o OUT
fi
if ((networks)); then
    train="train sr pairs.h5 $quiet --set width=0.1"
    each model.h5 file $train --set epochs=1 -o OUT
    each model.json stream $train --set epochs=1 -o aside.h5 --json OUT
    rm -f aside.h5*
fi

# Results go to a device, a pipe or a descriptor as they come.
expect 0 '' "'$wetcurl' inspect run wet.h5 --json /dev/null"
mkfifo pipe.json
"$wetcurl" inspect run wet.h5 --json pipe.json & cat pipe.json >through.json
wait $!
"$wetcurl" inspect run wet.h5 --json /dev/stdout >by_descriptor.json
"$wetcurl" inspect run wet.h5 --json - >usual.json
check 'a pipe takes the results' cmp through.json usual.json
check 'a descriptor takes the results' cmp by_descriptor.json usual.json
expect 1 'found a device' "'$wetcurl' simulate scene.toml --strands 16 $quiet --overwrite -o /dev/null"

# HDF5's own locks, which its environment variable may ask for, are no obstacle.
for word in TRUE BEST_EFFORT FALSE; do
    expect 0 '' "HDF5_USE_FILE_LOCKING=$word '$wetcurl' simulate scene.toml --strands 16 $quiet --overwrite -o run.h5"
done
rm -f run.h5

# ---- two processes, the first in the middle of its work ----

# Whether process $1 holds the lock of file $2.
locked_by() { grep -q "FLOCK.* $1 [0-9a-f:]*:$(stat -c %i "$2") " /proc/locks; }

# Starts `wetcurl $2... OUTPUT` and stops it as soon as it writes file $1. Begins again where it ended before that was
# seen, as happens on a busy machine.
begin() {
    local file=$1 tries
    shift
    for ((tries = 0; tries < 20; ++tries)); do
        "$wetcurl" "$@" >said 2>&1 &
        first=$!
        until [[ -e $file ]] && locked_by "$first" "$file"; do
            kill -0 "$first" 2>/dev/null || break
            sleep 0.005
        done
        kill -STOP "$first" 2>/dev/null && locked_by "$first" "$file" && return
        kill -CONT "$first" 2>/dev/null || true
        wait "$first" || break
        rm -rf "${@: -1}" "${@: -1}".*
    done
    fail "$*: ended before a second process could begin: $(<said)"
}
finish() {  # expected status
    local status=0
    kill -CONT "$first"
    wait "$first" || status=$?
    [[ $status == "$1" ]] || fail "the first process ended with $status: $(<said)"
    first=
}
refused() { expect 1 "found that process $first writes it" "'$wetcurl' $*"; }

long="simulate scene.toml --frames 80 $quiet"
"$wetcurl" $long -o alone.h5
begin run.h5.partial $long -o run.h5
refused $long -o run.h5
refused $long -o run.h5 --overwrite
finish 0
"$wetcurl" compare alone.h5 run.h5 --json compared.json --quiet >/dev/null
check 'the first run is what it would be alone' grep -q '"max": 0.0' compared.json
"$wetcurl" simulate scene.toml --frames 80 --strands 16 --dry $quiet -o long_low.h5

"$wetcurl" encode long_low.h5 alone.h5 $quiet -o alone_pairs.h5
begin long_pairs.h5.partial encode long_low.h5 alone.h5 $quiet -o long_pairs.h5
refused encode long_low.h5 alone.h5 $quiet -o long_pairs.h5 --overwrite
finish 0
check 'the first pairs are what they would be alone' cmp alone_pairs.h5 long_pairs.h5

# A frame of it takes less than a millisecond.
"$wetcurl" simulate scene.toml --frames 1500 --strands 16 --dry $quiet -o longest_low.h5
begin learned.h5.partial infer longest_low.h5 --interpolate rest $quiet -o learned.h5
refused infer longest_low.h5 --interpolate rest $quiet -o learned.h5 --overwrite
finish 0
check 'the first inferred run can be read' "$wetcurl" inspect run learned.h5

"$wetcurl" dataset recipe.toml $quiet -o alone_set
begin set/.lock dataset recipe.toml $quiet -o set
refused dataset recipe.toml $quiet -o set --resume
refused dataset recipe.toml $quiet -o set --overwrite
refused dataset recipe.toml $quiet -o set --part 1/2
finish 0
check 'the first data set is what it would be alone' diff -r alone_set set

if ((pictures)); then
    film="render alone.h5 --width 64 --height 64 $quiet"
    "$wetcurl" $film -o alone.webm
    begin film.partial.webm $film -o film.webm
    refused $film -o film.webm --overwrite
    finish 0
    [[ $(stat -c %s film.webm) == $(stat -c %s alone.webm) ]] || fail 'the first video is not what it would be alone'
fi
if ((networks)); then
    "$wetcurl" $train --set epochs=20 -o alone_model.h5 >/dev/null
    begin model.h5.partial $train --set epochs=20 -o model.h5
    refused $train --set epochs=20 -o model.h5 --overwrite
    refused $train --set epochs=20 -o model.h5 --resume
    finish 0
    check 'the first model is what it would be alone' cmp alone_model.h5 model.h5
    check 'the first log is whole' test "$(wc -l <model.h5.jsonl)" = 20
fi

# ---- a signal that comes twice, as timeout(1) sends it ----

twice() {  # condition to wait for, the command; its status and words go to `status` and `said`
    local condition=$1
    shift
    "$wetcurl" "$@" >said 2>&1 &
    first=$!
    until eval "$condition"; do
        kill -0 "$first" || { fail "$*: ended before it could be stopped: $(<said)" && return; }
        sleep 0.01
    done
    kill -TERM "$first"
    kill -TERM "$first" 2>/dev/null || true
    status=0
    wait "$first" || status=$?
    first=
}
twice '[[ -s stopped.h5.partial ]]' simulate scene.toml --frames 1000000 $quiet -o stopped.h5
[[ $status == 130 && $(<said) == *'frames are kept in stopped.h5.partial'* ]] || fail "stopped twice at once: $status: $(<said)"
check 'what was simulated can be read' "$wetcurl" inspect run stopped.h5.partial
if ((networks)); then
    twice '[[ -s endless.h5.jsonl ]]' $train --set epochs=100000 -o endless.h5
    [[ $status == 130 && $(<said) == *'endless.h5.checkpoint is left'* ]] || fail "stopped twice at once: $status: $(<said)"
    lines=$(wc -l <endless.h5.jsonl)
    twice '(($(wc -l <endless.h5.jsonl) > lines))' train sr pairs.h5 --set width=0.1 --threads 1 --set epochs=100000 -o endless.h5 --resume
    [[ $status == 130 && $(<said) == *'going on at epoch'* ]] || fail "resumed after both: $status: $(<said)"
fi

if ((!pictures || !networks)); then
    echo 'SKIP: what needs OpenCV or LibTorch, which this build lacks'
    ((failures)) || exit 77
fi
exit $((failures > 0))
