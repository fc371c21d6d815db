# Locks of wet hair by kind and number of strands: results/wet_looks/*.json.
include "shared";

[.wet_looks // {} | .[] | . as $kind | .counts[] | {
  kind: "`\($kind.hair)`", strands: (.strands | tostring), "particles a strand": $kind.particles,
  "gathered [mm]": .locks.gathered_mm,
  "drawn, at two thirds and near the tips [mm]": "\(.locks.drawn_mm | short), \(.locks.tips_mm | short)",
  "strands in a lock": (.locks.strands | round | tostring),
  "frame [ms]": (1000 * .frame_seconds), "of it neighbours and Eq 10 [ms]": (1000 * (.stages.neighbours + .stages.cohesion)),
  machine: $kind.provenance}] | table
