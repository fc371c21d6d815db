# Where the numbers of each kind of hair come from.
include "shared";

def order: {type1: 0, child: 90, horse: 91}[.hair] // (.hair | ltrimstr("type") | .[0:1] | tonumber * 10) + (.hair | explode[-1] - 96);
[.hair[]] | sort_by(order) | map({kind: "`\(.hair)`", fibre: .source_of_fibre, curl: .source_of_curl}) | table
