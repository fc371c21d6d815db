# Bytes per particle of all buffers of the simulation, 9900 strands, by machine.
include "shared"; include "bench";

[.bench[]] as $all |
[(["wet frame", "wet"], ["dry frame", "dry"], ["frame with flow", "water flow"],
  ["frame with strand contact", "contact between strands"],
  ["frame with cohesion in the solve", "cohesion in the solve"]) as [$kind, $title] |
  {"9900 x 100": $title} + ($all | map({(machine): entry("\($kind), 9900 strands").bytes_per_particle}) | add)] |
filled(1) | table
