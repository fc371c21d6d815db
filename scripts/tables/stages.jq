# Stages of a wet frame by machine, with ten passes of Eq 10, with over-relaxed sweeps and with one pass.
include "shared"; include "bench";

[.bench[] | . as $file | (512, 9900) as $strands |
  (["wet frame", "ten passes"], ["wet frame, Eq 10 over-relaxed", "over-relaxed"],
   ["wet frame, Eq 10 with passes = 1", "one pass"]) as [$kind, $passes] |
  "\($kind), \($strands) strands" as $name | $file | select(entry($name)) |
  {"strands x 100": $strands, machine: machine, "Eq 10": $passes, frame: (median($name) | with("ms")),
   substeps: (median("\($name): chain") | with("ms")), "neighbour lists": (median("\($name): neighbours") | with("ms")),
   passes: (median("\($name): cohesion") | with("ms")), error: (entry($name).error_mm | with("mm"))}] | table
