# Error against run time on two cores: rows of the 24 unseen scenes by the time of a frame, all of it counted.
include "shared"; include "learned";

.learned.from_2_substeps_on_2_cores as $learned | ($learned | quad) as $quad |
{"nearest": "nearest strand", "quad": "quad interpolation", "core": "core and detail", "rest": "carried rest shapes", "rest_9_10": "carried rest shapes with Eq 9, then Eq 10",
 "wet_4_substeps_20_mm_relaxed": "wet simulation, 4 substeps, Eq 10 every 20 mm over-relaxed",
 "wet_2_substeps_12_mm_relaxed": "wet simulation, 2 substeps, Eq 10 every 12.5 mm over-relaxed"} as $titles |
[$learned.rows | sort_by(.seconds_per_frame)[] | select(.kind == "learned" or $titles[.name]) |
  {"": ($titles[.name] // "`\(.name)`"), "time of a frame [ms]": (1e3 * .seconds_per_frame), "error [mm]": error_mm,
   "of quad": (error_mm / $quad), "worst scene [mm]": .worst.position_mm,
   "clump density": (.crowd / .crowd_reference)}] | table,
"", ([$learned] | made_of)
