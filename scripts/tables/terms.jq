# Median time of a wet frame with a further term, by size and machine; in brackets the stage of the term.
include "shared"; include "bench";

[.bench[]] as $all |
def stage($name): [.entries[] | select(.name | startswith("\($name): ")) | .milliseconds.median] | max;
[("flow", "strand contact", "adhesion", "cohesion in the solve", "Lin 2015", "Kim 2016", "boundary particles") as $term |
  {term: $term} + ([(512, 9900) as $strands | $all[] | "frame with \($term), \($strands) strands" as $name |
    {"\($strands) x 100, \(machine)":
      (if median($name) then "\(median($name) | short) ms (\(stage($name) | short) ms)" else null end)}] | add)] |
filled(1) | table
