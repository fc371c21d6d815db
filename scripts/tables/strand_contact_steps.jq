# How far results move with the step, with contact between strands and without, of scripts/strand_contact.
include "shared";

[(.strand_contact // {})[] | .provenance as $provenance | .rows[] | . as $row |
  {"as drawn": .pairs, "from one rest": .pairs_from_one_rest} | to_entries[] | .value as $pairs |
  {machine: $provenance, "between strands": (if $row.contact == "with" then "contact" else "none" end), "runs begin": .key} +
  ($pairs | map({"\(.substeps) against \(.against)": (.mean_mm | with("mm"))}) | add) +
  {"order, coarse and fine": ([0, 1] | map($pairs[.].mean_mm / $pairs[. + 1].mean_mm | log2 | short) | join(", "))}] | table
