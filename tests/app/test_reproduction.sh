#!/usr/bin/env bash
# The items of scripts/reproduce: each is well formed, is listed, and is found by each of its names; broken ones are seen.
# Use: test_reproduction.sh PROJECT
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/expect.sh"
project=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
if ! command -v jq >/dev/null; then
    echo "SKIP: jq is not there, which scripts/reproduce and scripts/pages read JSON with"
    exit 77
fi

# What is wrong with the items in PROJECT/scripts/reproduction, one line each.
complaints() {
    local items=$1/scripts/reproduction file item listed name also names
    listed=$("$1/scripts/reproduce")
    for file in "$items"/*.sh; do
        item=$(basename -s .sh "$file")
        [[ $item =~ ^[a-z0-9_]+$ ]] || echo "$item: a name of small letters, digits and _ is needed"
        [[ $(head -n 1 "$file") =~ ^'# '[^:]+': '.+ ]] || echo "$item: its first line is no title '# FIGURE: what it shows'"
        bash -n "$file" 2>/dev/null || echo "$item: bash cannot read it"
        grep -qE '^ *(row|seen|source) ' "$file" || echo "$item: it judges nothing: no row, no line seen"
        grep -qE "^$item +[-0-9.]+ +" <<<"$listed" || echo "$item: scripts/reproduce does not list it"
        grep -E '^# needs:' "$file" | grep -qvE '^# needs: (cpu|cuda)$' && echo "$item: it needs cpu or cuda, nothing else"
        also=$(sed -n 's/^# also: //p' "$file")
        for name in $also; do
            [[ -f $1/scenes/$name.toml || $name =~ ^(fig|table|scene|sec|eq)[0-9a-z]+$ ]] || echo "$item: its other name '$name' is no figure, table, scene or equation"
        done
    done
    # Every scene of the paper, and every figure and table with a result, is some item's.
    names=" $({ basename -s .sh "$items"/*.sh; sed -n 's/^# also: //p' "$items"/*.sh; } | tr '\n' ' ') "
    for name in $(basename -a -s .toml "$1"/scenes/scene*.toml) fig{2,3,4,5,6,8,9,10,11,12} fig{21..41} table{1..6}; do
        [[ $names == *" $name "* ]] || echo "$name: no item has this name"
    done
}

wrong=$(complaints "$project")
[[ -z $wrong ]] || { echo "FAILED: $wrong"; failures=$((failures + 1)); }
expect 2 "found item 'fig0'" "'$project/scripts/reproduce' fig0"
expect 2 "unexpected '--fast'" "'$project/scripts/reproduce' --fast"

# The same of a copy whose items are broken, one thing each.
mkdir -p "$folder/scenes"
touch "$folder/scenes/scene99.toml"
cp -r "$project/scripts" "$folder/scripts"
items=$folder/scripts/reproduction
first=$(basename -s .sh "$(ls "$items"/*.sh | head -n 1)")
echo 'row a b 1 0 2 c' >"$items/untitled.sh"
printf '# Fig 0: judges nothing\n# also: somewhere\n' >"$items/idle.sh"
printf '# Fig 0: needs what there is not\n# needs: gpu\nrow a b 1 0 2 c\n' >"$items/needy.sh"
printf '# Fig 0: no bash\nrow a b 1 0 2 c\nif\n' >"$items/unread.sh"
seen=$(complaints "$folder")
for expected in "untitled: its first line" "idle: it judges nothing" "idle: its other name 'somewhere'" "unread: bash cannot read it" "needy: it needs cpu or cuda" "scene99: no item"; do
    if [[ $seen == *"$expected"* ]]; then echo "ok: seen: $expected"; else
        echo "FAILED: not seen: $expected"
        failures=$((failures + 1))
    fi
done

# A page that is not what its data say is seen; what renders it, puts it right.
mkdir -p "$folder/results/reproduction" "$folder/docs"
rm "$items"/{untitled,idle,unread,needy}.sh
jq -n --arg item "$first" '{item: $item, title: "T", made: {revisions: "r", processor: "p", cores: 2, compiler: "c", device: "cpu", gpu: "none", date: "d", seconds: 1},
    rows: [{what: "w", paper: "1", ours: 1.5, agrees: "no", why: "a | b"}], tables: [], pictures: [], notes: []}' >"$folder/results/reproduction/$first.json"
echo stale >"$folder/docs/reproduction.md"
expect 1 'is not what results/reproduction says' "'$folder/scripts/pages' --check"
expect 0 '' "'$folder/scripts/pages'"
expect 0 '' "'$folder/scripts/pages' --check"
grep -q '| w | 1 | 1.5 | no | a \\| b |' "$folder/docs/reproduction.md" || { echo "FAILED: the page lacks its row"; failures=$((failures + 1)); }

# So is a table of another page; one that nobody makes, and one without an end, are refused.
printf '%s\n' '# A page' "<!-- table: reproduced $first -->" stale '<!-- end -->' >"$folder/docs/page.md"
expect 1 'docs/page.md is not what its data says' "'$folder/scripts/pages' --check"
expect 0 '' "'$folder/scripts/pages'"
expect 0 '' "'$folder/scripts/pages' --check"
grep -q '^| w | 1.5 |$' "$folder/docs/page.md" || { echo "FAILED: the page lacks its table"; failures=$((failures + 1)); }
echo '<!-- table: nothing -->' >>"$folder/docs/page.md"
expect 1 "found table 'nothing', allowed: " "'$folder/scripts/pages' --check"
sed -i 's/nothing/winners/' "$folder/docs/page.md"
expect 1 "table 'winners' has no <!-- end -->" "'$folder/scripts/pages' --check"
exit $((failures > 0))
