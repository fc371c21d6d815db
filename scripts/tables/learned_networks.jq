# All rows of networks on the 24 unseen scenes, and their errors over those of the ways without a network.
include "shared"; include "learned";

[.learned.from_2_substeps_on_2_cores] as $files |
([$files[] | quad as $quad | best as $best | .rows[] | select(.kind == "learned") |
  {"": "`\(.name)`", "error [mm]": error_mm, "of length": (.position_rel | percent), "of quad": (error_mm / $quad),
   "of the best baseline": (error_mm / $best), "worst scene [mm]": .worst.position_mm, "curl radius": .curl_radius_ratio,
   "tip spread": .tip_spread_ratio, "clump density": (.crowd / .crowd_reference), jitter: jitter,
   edges: (.stretch_mean | percent)}] | table),
"",
"The mean change of edges in the reference is \($files[0].rows[0].stretch_mean_reference | percent).",
"",
($files | made_of)
