# Simulations, networks and baselines on the 24 unseen scenes, from dry runs of two substeps a frame, beside the time of
# such a frame of 39,600 strands on a GPU.
include "shared"; include "bench"; include "learned";

gpu as $gpu | .learned.from_2_substeps as $learned |
"simulated and learned frame" as $frame | "Eq 10 every 12.5 mm over-relaxed" as $cheap |
[["wet simulation: the reference", "wet_10_substeps", "wet frame"],
 ["the same in double precision", "wet_double", null],
 ["the same, 20 substeps", "wet_20_substeps", null],
 ["cheap Eq 10", "wet_12_mm_relaxed", "wet frame, \($cheap)"],
 ["cheap Eq 10, 4 substeps", "wet_4_substeps_12_mm_relaxed", "wet frame of 4 substeps, \($cheap)"],
 ["cheap Eq 10, 2 substeps", "wet_2_substeps_12_mm_relaxed", "wet frame of 2 substeps, \($cheap)"],
 ["Eq 10 every 20 mm, over-relaxed, 4 substeps", "wet_4_substeps_20_mm_relaxed",
  "wet frame of 4 substeps, Eq 10 every 20 mm over-relaxed"],
 ["`strand_m_2`, then Eq 10", "strand_m_2", "\($frame) with Eq 10", ", strand_m_2"],
 ["`strand_m_2`, then cheap Eq 10", "strand_m_2_relaxed", "\($frame) with \($cheap)", ", strand_m_2"],
 ["`displayed_m_2`", "displayed_m_2", $frame, ", displayed_m_2"],
 ["`displayed_m_2`, then 8 passes of Eq 10 every 10 mm", "displayed_m_2_8_passes", null],
 ["carried rest shapes with Eq 9, then Eq 10", "rest_9_10", null],
 ["the same, settled", "rest_9_10_settled", null],
 ["quad interpolation", "quad", null],
 ["core and detail", "core", null],
 ["wet low-resolution run: carried rest shapes with Eq 9, then Eq 10", "wet_low_rest_9_10", null],
 ["wet low-resolution run: quad interpolation", "wet_low_quad", null],
 ["dry simulation of all strands, then Eq 10", "dry_high_10", null]] |
map(. as [$title, $name, $timed, $model] | ($learned | row($name)) | select(.) |
  {"": $title, "error [mm]": error_mm, "of length": (.position_rel | percent), "worst scene [mm]": .worst.position_mm,
   F1: .f1_3mm_30deg, "curl radius": .curl_radius_ratio, "tip spread": .tip_spread_ratio,
   "clump density": (.crowd / .crowd_reference), jitter: jitter,
   "\($gpu | machine) [ms]": (if $timed then $gpu | median("\($timed), 39600 strands\($model // "")") else null end)}) |
table, "", ([$learned] | made_of)
