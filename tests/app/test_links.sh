#!/usr/bin/env bash
# Every relative link of a page leads to a file of the repository, and every file of the sources that it names in code
# letters is there.
# Use: test_links.sh PROJECT
set -euo pipefail
cd "$1"
git rev-parse --git-dir >/dev/null 2>&1 || { echo "SKIP: not a git checkout, which lists the pages"; exit 77; }
failures=0
complain() { echo "FAILED: $1"; failures=$((failures + 1)); }
links=0
while IFS=: read -r page line target; do
    links=$((links + 1))
    target=${target%%#*}
    [[ -z $target || -e $(dirname "$page")/$target ]] || complain "$page:$line: links to $target, which is not there"
done < <(git ls-files '*.md' | xargs grep -noE '\]\([^) ]+\)' | sed -E 's/\]\((.*)\)$/\1/' | grep -vE ':(https?|mailto):')
while IFS=: read -r page line name; do
    links=$((links + 1))
    [[ -e $name || $name =~ quadratic_drag|goal_spring|strand_gated ]] || complain "$page:$line: names $name, which is not there"
# Those three are the reader's to write.
done < <(git ls-files 'docs/*.md' README.md CONTRIBUTING.md | xargs grep -noE '`(base|solver|cuda|models|learn|training|app|scripts|scenes)/[a-z0-9_/]+\.(h|cpp|cu|toml|bash|sh)`' | tr -d '`')
((links > 200)) || complain "found $links links and names, which is too few: does the search still find them?"
echo "$links links and names, $failures wrong"
exit $((failures > 0))
