# How far results move with the step, with contact between strands and without, of scripts/strand_contact.
include "shared";

[(.strand_contact // {})[] | .provenance as $provenance | .rows[] | .pairs as $pairs |
  {machine: $provenance, "between strands": (if .contact == "with" then "contact" else "none" end)} +
  ($pairs | map({"\(.substeps) against \(.against)": (.mean_mm | with("mm"))}) | add) +
  {"order, last": (($pairs[1].mean_mm / $pairs[2].mean_mm | log2) | short)}] | table
