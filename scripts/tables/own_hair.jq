# Networks trained further on one's own hair: results/own_hair/*.json.
include "shared";

def row($name): .rows[] | select(.row == $name).position_mm;
[.own_hair // {} | .[] | {
  groom: "`\(.groom)`", strands: "\(.strands) from \(.low_strands)", "begun with": "`\(.network)`",
  "data and training [s]": (.seconds | round | tostring),
  "quad [mm]": row("quad"), "rest, Eq 9 and 10 [mm]": row("rest"), "released network [mm]": row("released"), "trained further [mm]": row("tuned"),
  "of quad": (row("tuned") / row("quad")), machine: .provenance}] | table
