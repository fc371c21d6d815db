# Median time of simulated frames by machine, and the largest error of the machines.
include "shared"; include "bench";

[.bench[]] as $all |
[("wet frame", "wet frame, head at rest", "dry frame") as $kind | (512, 9900, 100000) as $strands |
  "\($kind), \($strands) strands" as $name |
  {"strands x 100": "\($strands), \($kind | sub(" frame"; ""))"}
  + ($all | map({(machine): (median($name) | with("ms"))}) | add)
  + {error: ([$all[] | entry($name).error_mm | values] | max | with("mm"))}] |
filled(1) | table
