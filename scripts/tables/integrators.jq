# Error and time by the number of substeps, 512 wet strands; the explicit scheme diverges.
include "shared"; include "bench";

[.bench[] | machine as $machine | .error_against_time | map(select(.integrator != "explicit")) |
  group_by([.integrator, .precision])[] |
  {machine: $machine, integrator: .[0].integrator, precision: .[0].precision}
  + (sort_by(.substeps) | map({"\(.substeps)":
      (if .error_mm == null then "diverges" else "\(.error_mm | short) mm, \(.milliseconds | short) ms" end)}) | add)] | table
