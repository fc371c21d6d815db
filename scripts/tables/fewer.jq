# Errors by how many strands the low-resolution run has: of the ways without a network and of networks.
include "shared"; include "learned";

def cell($name; $quad): row($name) | error_mm | "\(short) (\(. / $quad | short))";
[["256 on the grid", .learned.from_2_substeps_on_2_cores], ["64 on the grid", .learned.from_2_substeps_of_64_strands],
 ["64 guides", .learned.from_2_substeps_of_64_guides], ["16 on the grid", .learned.from_2_substeps_of_16_strands],
 ["16 guides", .learned.from_2_substeps_of_16_guides]] as $all |
[$all[] | .[0] as $from | .[1] | quad as $quad |
  {"simulated of 1024": $from, scenes: (.rows[0].scenes | tostring), "quad [mm]": $quad, "no network: rest shapes, Eq 9, Eq 10": cell("rest_9_10"; $quad),
   "displayed, narrow": cell("displayed_s"; $quad), displayed: cell("displayed_m"; $quad),
   "strands, cheap Eq 10": cell("strand_m_relaxed"; $quad)}] | table,
"", ([$all[][1]] | made_of)
