# What the released networks are to reach, and what they reach.
include "shared"; include "bench"; include "learned";

def judged($low; $high):
  if . == null then null else short + (if $low <= . and . <= $high then "" else ", missed" end) end;

gpu as $gpu | ($gpu | median("wet frame, 39600 strands")) as $wet | .learned as $learned |
"simulated and learned frame" as $frame |
[["strand_m", $learned.from_10_substeps, "\($frame) with Eq 10, 39600 strands, strand_m"],
 ["strand_m_2_relaxed", $learned.from_2_substeps,
  "\($frame) with Eq 10 every 12.5 mm over-relaxed, 39600 strands, strand_m_2"],
 ["displayed_m", $learned.from_10_substeps, "\($frame), 39600 strands, displayed_m"],
 ["displayed_m_2", $learned.from_2_substeps, "\($frame), 39600 strands, displayed_m_2"]] |
map(. as [$name, $file, $timed] | $file |
  {name: $name, row: row($name), quad: quad, best: best, ms: ($gpu | median($timed))}) as $networks |
# Of each network, one number, which is to lie between the two bounds.
def numbers(f; $low; $high): $networks | map({"`\(.name)`": (f | judged($low; $high))}) | add;
[{quantity: "error, over quad interpolation of the same run", target: "at most 0.30"}
   + numbers((.row | error_mm) / .quad; 0; 0.3),
 {quantity: "error, over the best baseline", target: "at most 0.67"} + numbers((.row | error_mm) / .best; 0; 0.67),
 {quantity: "time on one \($gpu | machine), over the wet simulation’s", target: "at most 0.10"}
   + numbers(if .ms and $wet then .ms / $wet else null end; 0; 0.1),
 {quantity: "curl radius", target: "at least 0.95"} + numbers(.row.curl_radius_ratio; 0.95; infinite),
 {quantity: "tip spread", target: "0.90 to 1.10"} + numbers(.row.tip_spread_ratio; 0.9; 1.1),
 {quantity: "mean change of edges, over the reference’s", target: "at most 1"}
   + numbers(.row | .stretch_mean / .stretch_mean_reference; 0; 1),
 {quantity: "jitter", target: "at most 1.2"} + numbers(.row | jitter; 0; 1.2),
 {quantity: "deepest particle in the head [mm]", target: "at most 0.5"}
   + numbers(.row.penetration.max_mm | . * 1e3 | round / 1e3; 0; 0.5)] | table
