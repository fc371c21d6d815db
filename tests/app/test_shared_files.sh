#!/usr/bin/env bash
# Real grooms and heads, and small inputs that once went wrong: no strand is lost, nothing crashes, nothing fails without
# a word (scripts/try_files). They lie in shared/ beside the project; ends with 77 where that is not there.
#
#   test_shared_files.sh WETCURL PROJECT
set -euo pipefail
shared=$2/../shared
[[ -d $shared/data && -d $shared/cases ]] || { echo "SKIP: no shared/data and shared/cases beside the project"; exit 77; }
table=$(WETCURL=$1 "$2/scripts/try_files" "$shared/data" "$shared/cases")
echo "$table"
# Strands in and back, as the files' own descriptions have them.
for row in 'Bangs_100.abc | 100 strands, 100 back' 'harolongo.data | 7905 strands, 7905 back' \
    'yuksel_straight.hair | 10000 strands, 10000 back' 'three.data | 3 strands, 3 back' 'five.data | 5 strands, 5 back'; do
    [[ $table == *"$row | runs"* ]] || { echo "not found: $row"; exit 1; }
done
