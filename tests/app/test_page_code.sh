#!/usr/bin/env bash
# The C++ of the pages that say how to add a term and a network compiles.
# Use: test_page_code.sh PROJECT COMPILER [FOLDERS of LibTorch's headers, ':' between]
#
# `<!-- file: PATH -->` above a block: the block is that file. What the pages tell to change in files that are there is
# changed in copies of these, which the compiler finds first.
set -euo pipefail
project=$1 compiler=$2 torch=${3:-}
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
failures=0 compiled=0

# Writes the files of the page $1.
write_files_of() {
    awk -v folder="$folder" '
        /^<!-- file: .* -->$/ { file = folder "/" $3; next }
        /^```cpp$/ && file { writing = 1; system("mkdir -p $(dirname " file ")"); next }
        /^```$/ && writing { writing = 0; close(file); file = ""; next }
        writing { print >file }' "$project/docs/$1"
}
# A copy of the project's file $1, through the sed script $2, which must change it.
changed() {
    mkdir -p "$folder/$(dirname "$1")"
    sed "$2" "$project/$1" >"$folder/$1"
    ! cmp -s "$project/$1" "$folder/$1" || { echo "FAILED: nothing of $1 changes by $2"; failures=$((failures + 1)); }
}
compiles() {  # file, more arguments
    compiled=$((compiled + 1))
    "$compiler" -std=c++20 -O0 -fopenmp -fsyntax-only -Wall -Wextra -Werror -I"$folder" -I"$project" -isystem /usr/include/eigen3 \
        -DWETCURL_SOURCE_DIR='""' "${@:2}" "$folder/$1" 2>"$folder/said" || {
        echo "FAILED: $1 of the page does not compile"
        head -n 20 "$folder/said"
        failures=$((failures + 1))
    }
}

write_files_of add_a_term.md
write_files_of add_a_network.md
for file in solver/terms/{quadratic_drag,goal_spring}.h tests/solver/test_quadratic_drag.cpp models/strand_gated.{h,cpp}; do
    [[ -s $folder/$file ]] || { echo "FAILED: no page has a block for $file"; exit 1; }
done

# The slot of the drag, as the page has it.
slots=$(awk '/^using ChainTerms =$/ { on = 1 } on { printf "%s\\n", $0 } on && /;$/ { exit }' "$project/docs/add_a_term.md")
changed solver/terms/list.h "/^using ChainTerms/,/;\$/c\\${slots%\\n}
s|^#include \"solver/terms/slot.h\"|&\n#include \"solver/terms/quadratic_drag.h\"|"
compiles tests/solver/test_quadratic_drag.cpp

# The line of the array, and the members of the view.
row=$(grep -oE '`ROW\(goal.*\)`' "$project/docs/add_a_term.md" | head -n 1 | tr -d '`')
changed solver/terms/strand_arrays.h "s|^    /\* \[m/s\] velocity of the air|    $row \\\\\n&|"
changed solver/terms/chain.h 's|^    Vec3<S> chord; |    Quat<S> root_rotation;\n&|
s|^        root_spin = root.spin,|        root_rotation = root.rotation;\n&|'
cat >"$folder/goal.cpp" <<'CPP'
#include "solver/terms/goal_spring.h"
template double wetcurl::GoalSpring::energy(const ChainView<double>&) const;
template void wetcurl::GoalSpring::assemble(const ChainView<double>&, const ChainSystem<double>&, int, int) const;
CPP
compiles goal.cpp

if [[ -n $torch ]]; then
    includes=()
    while read -r path; do
        [[ -z $path || $(realpath "$path") == /usr/include ]] || includes+=(-isystem "$path")  # that one is searched anyway, and last
    done < <(tr ':' '\n' <<<"$torch")
    compiles models/strand_gated.cpp "${includes[@]}"
fi
echo "$compiled files of pages, $failures failures"
exit $((failures > 0))
