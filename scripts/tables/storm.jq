# How random scenes end, of `wetcurl stability --storm`.
include "shared";

.stability.storm as {$ends, $silent} |
[{"random scenes": ($ends | add), whole: $ends.whole, "whole, with a warning": $ends.warned, diverged: $ends.diverged,
  "refused when read": $ends.refused, "exploded in silence": $silent}] | table
