# What tables of kinds of hair share: the results in the order of the names, types before others.

def kinds:
  [.hair[]] | sort_by({child: 90, horse: 91}[.hair] // (.hair | ltrimstr("type") | .[0:1] | tonumber * 10) + (.hair | explode[-1] - 96));
