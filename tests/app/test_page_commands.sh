#!/usr/bin/env bash
# Every command of a page runs: those of the program as they stand there, in the page's order, on little hair and few
# frames; scripts, presets and test programs are there and take the options that are named.
# Use: test_page_commands.sh WETCURL PROJECT
#
# A command is a line that is indented by four spaces. `<!-- not run: REASON -->` above a block leaves the block out.
set -euo pipefail
wetcurl=$1
cd "$2"
project=$PWD
git rev-parse --git-dir >/dev/null 2>&1 || { echo "SKIP: not a git checkout, which lists the pages"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
ran=0 failures=0
complain() { echo "FAILED: $1"; failures=$((failures + 1)); }

# The program, on less: what a page says decides all but the sizes.
mkdir "$folder/bin"
cat >"$folder/bin/wetcurl" <<'END'
#!/usr/bin/env bash
set -euo pipefail
hair=(--set "groom.grid=[8,8]" --set integrator.settle=0)
words=() more=(--overwrite --quiet) last=
for word in "$@"; do
    case $last in
        --strands) word=16 ;;
        --frame) word=1 ;;
        --frames) [[ ${words[0]} == export ]] || word=3 ;;
        --device) word=cpu ;;
        --filter) word='level set build 16' ;;
    esac
    words+=("$word") last=$word
done
case ${words[0]} in
    simulate) more+=("${hair[@]}" --frames 3) ;;
    infer) [[ ${words[1]} != *.toml ]] || more+=("${hair[@]}" --frames 3) ;;
    train) more+=(--set epochs=1) ;;
    dataset) more+=(--set splits.train=1 --set splits.validation=0 --set splits.test=1 --set every=40) ;;
esac
exec "$WETCURL" "${words[@]}" "${more[@]}"
END
chmod +x "$folder/bin/wetcurl"
export WETCURL=$wetcurl PATH=$folder/bin:$PATH

# commands_of PAGE: its commands as LINE<tab>COMMAND, those on several lines as one.
commands_of() {
    awk '/^<!-- not run: .* -->$/ { skipped = 1; next }
         !/^    / { if (NF) { skipped = skipped && !in_block } in_block = 0; if (NF) skipped = 0; next }
         { in_block = 1 }
         skipped { next }
         { line = substr($0, 5)
           if (begun == "") at = FNR
           begun = begun line
           if (sub(/\\$/, "", begun)) next
           print at "\t" begun; begun = "" }' "$1"
}
runs_of_scratch() {  # the runs that a page takes for granted
    local run
    for run in "$@"; do
        [[ ! -e $run ]] || continue
        case $run in
            dry.h5) wetcurl simulate scenes/demo.toml --dry --strands 16 -o dry.h5 ;;
            ours.h5 | lin.h5 | kim.h5) wetcurl simulate "scenes/compare_${run%.h5}.toml" -o "$run" ;;
            wet.h5) wetcurl simulate scenes/demo.toml -o wet.h5 ;;
            scene.toml) cp scenes/demo.toml scene.toml ;;
            pairs.h5) runs_of_scratch dry.h5 wet.h5 && wetcurl encode dry.h5 wet.h5 -o pairs.h5 ;;
        esac
    done
}
# check COMMAND: runs it, or looks whether what it names is there.
check() {
    local command=$1 first name
    command=$(sed -E 's/(^|[^ ]) +#.*$/\1/; s/^mpirun ([^w][^ ]* +)*//; s#build/[a-z]+/bin/wetcurl#wetcurl#' <<<"$command")
    while [[ $command =~ ^[A-Z_]+=(\"[^\"]*\"|[^ ]*)\ +(.*)$ ]]; do command=${BASH_REMATCH[2]}; done
    read -r first name _ <<<"$command"
    case $first in
        wetcurl)
            # shellcheck disable=SC2046,SC2086 # words of the command
            runs_of_scratch $(printf '%s\n' $command | grep -E '^(dry|wet|ours|lin|kim|pairs)\.h5$|^scene\.toml$' | grep -vxF "$(grep -oE '(-o|--output) +[^ ]+' <<<"$command" | awk '{ print $2 }')" || true) >/dev/null
            eval "$command" ;;
        scripts/*)
            "$project/$first" --help >/dev/null || return
            for name in ${command%%&&*}; do
                case $first:$name in
                    *":$first") ;;
                    scripts/reproduce:*) [[ -e $project/scripts/reproduction/$name.sh ]] || grep -q "^# also:.* $name\b" "$project"/scripts/reproduction/*.sh || { echo "no item $name"; return 1; } ;;
                    *:--*) "$project/$first" --help | grep -qe "$name" || { echo "$first --help does not tell of $name"; return 1; } ;;
                    scripts/build:*) grep -q "\"name\": \"$name\"" "$project/CMakePresets.json" || { echo "no preset $name"; return 1; } ;;
                esac
            done ;;
        cmake | ctest)
            for name in $(grep -oE -- '--preset +[a-z_]+' <<<"$command" | awk '{ print $2 }'); do
                grep -q "\"name\": \"$name\"" "$project/CMakePresets.json" || { echo "no preset $name"; return 1; }
            done ;;
        build/*/bin/test_*)
            name=$(sed -nE "s/.*--gtest_filter='?([^' ]+)'?.*/\1/p" <<<"$command")
            local program=$(dirname "$wetcurl")/${first##*/}
            [[ -z $name || ! -e $program ]] || [[ $("$program" --gtest_list_tests --gtest_filter="$name" | wc -l) -gt 1 ]] || { echo "no test $name"; return 1; } ;;
        perf | valgrind | callgrind_annotate | mpirun) ;;  # of the machine
        *) return 3 ;;
    esac
}
for page in $(git ls-files '*.md'); do
    [[ $page != docs/cli.md && $page != docs/reproduction.md && $page != docs/results/* ]] || continue
    work=$folder/$(tr / _ <<<"$page")
    mkdir "$work"
    ln -s "$project/scenes" "$project/models" "$work/"
    mkdir "$work/out"
    cd "$work"
    while IFS=$'\t' read -r line command; do
        status=0
        check "$command" >"$folder/log" 2>&1 </dev/null || status=$?
        [[ $status != 3 ]] || continue  # not a command
        ran=$((ran + 1))
        [[ $status == 0 ]] || { complain "$page:$line: $command"; tail -n 5 "$folder/log"; }
    done < <(commands_of "$project/$page")
    cd "$project"
    rm -rf "$work"
done
((ran > 60)) || complain "found $ran commands, which is too few: does the search still find them?"
echo "$ran commands, $failures failed"
exit $((failures > 0))
