#!/usr/bin/env bash
# No page holds a measured number, a commit hash or a checksum that was typed by hand: scripts/pages renders them from data.
# Use: test_typed_numbers.sh PROJECT
#
# Rendered are pages that say so at their head, and what lies between <!-- table: NAME --> and <!-- end -->. Elsewhere these
# are typed numbers:
# - a hash: a word of 7 or more of the digits 0-9a-f, with letters and digits among them;
# - a number before µs, ms, s, min, %, KB, MB, GB, GB/s, Gflop/s or Tflop/s;
# - a number with a decimal point before mm;
# - in a row of a table: any number before mm or bytes.
# A setting that looks so is written as an option (`--spacing 0.0125`), a bound in words.
set -euo pipefail
cd "$1"
git rev-parse --git-dir >/dev/null 2>&1 || { echo "SKIP: not a git checkout, which lists the pages"; exit 77; }
failures=0

# What is typed and allowed, as PAGE: WORDS, a regular expression a line, with its reason.
allowed=(
    'models/weights/strands.md: 482a9cf'  # the revision of hair of another project, which nothing here makes
)

# The typed numbers of pages, one a line, as PAGE:LINE: WORDS.
typed() {
    awk '
        function found(pattern, text,   word) {
            while (match(text, pattern)) {
                word = substr(text, RSTART, RLENGTH)
                text = substr(text, RSTART + RLENGTH)
                gsub(/^[^0-9a-f]+|[^0-9a-zµ%\/]+$/, "", word)
                if (pattern != hash || (word ~ /[0-9]/ && word ~ /[a-f]/)) print FILENAME ":" FNR ": " word
            }
        }
        BEGIN {
            hash = "(^|[^0-9A-Za-z_.-])[0-9a-f][0-9a-f][0-9a-f][0-9a-f][0-9a-f][0-9a-f][0-9a-f]+([^0-9A-Za-z_]|$)"
            start = "(^|[^0-9A-Za-z_.])"
            end = "([^0-9A-Za-z_/²³]|$)"
        }
        FNR == 1 { rendered = 0 }
        FNR <= 5 && /^<!-- Rendered by scripts\/pages/ { rendered = 1 }
        rendered == 1 { next }
        /^<!-- table: / { rendered = 2 }
        /^<!-- end -->/ { rendered = 0 }
        rendered { next }
        {
            found(hash, $0)
            found(start "[0-9]([0-9.,]*[0-9])? ?(µs|ms|s|min|%|KB|MB|GB|GB/s|Gflop/s|Tflop/s)" end, $0)
            if (/^\|/) found(start "[0-9]([0-9.,]*[0-9])? ?(mm|bytes)" end, $0)
            else found(start "[0-9]+\\.[0-9]+ ?mm" end, $0)
        }' "$@"
}
mapfile -t pages < <(git ls-files '*.md')
while IFS= read -r line; do
    for words in "${allowed[@]}"; do [[ ! $(sed -E 's/:[0-9]+:/:/' <<<"$line") =~ $words ]] || continue 2; done
    echo "FAILED: $line: a number that was typed; render it by scripts/pages from data, or say it in words"
    failures=$((failures + 1))
done < <(typed "${pages[@]}")

# Each kind is seen, and what is rendered or is a setting is not.
page=$(mktemp --suffix .md)
trap 'rm -f "$page"' EXIT
seen() {
    local count
    printf '%s\n' "${@:2}" >"$page"
    count=$(typed "$page" | wc -l)
    [[ $count == "$1" ]] || { echo "FAILED: found $count typed numbers in place of $1: ${*:2}"; failures=$((failures + 1)); }
}
seen 1 'Measured at 80e94ef.'
seen 1 "| file | \`$(sha256sum "$page" | cut -d' ' -f1)\` |"
seen 1 'A frame takes 11.2 ms.'
seen 2 '| wet | 4.02 mm | 1.25 % |'
seen 1 '| trained | 34 s |'
seen 2 'The error is 4.02 mm, a hundredth is 1 %.'
seen 0 'Every 10 mm along a strand; the decade 1234567, the word defaced, `--seed 1`.' '| strands | 512 x 100 | [mm] |' '| gravity [m/s²] | 9 |'
seen 0 '<!-- table: frames -->' '| wet | 4.02 mm |' '<!-- end -->'
seen 1 '<!-- table: frames -->' '<!-- end -->' '| wet | 4.02 mm |'
seen 0 '# A page' '' '<!-- Rendered by scripts/pages from data -->' '| wet | 4.02 mm | 80e94ef |'
echo "$failures failures"
exit $((failures > 0))
