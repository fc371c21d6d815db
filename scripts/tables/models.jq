# NAME...: what each strand network reads and predicts, its size, and its error on held-out data.
include "shared"; include "models";

[models |
  {"": "`\(.name)`", from: "\(.low) runs, \(.low_substeps) or more substeps a frame",
   predicts: (if .target == "strands" then "strands before Eq 10" else "displayed strands" end),
   architecture, width, weights: (.parameters | tostring), "held out [mm]": .numbers.validation_mm,
   "the base there [mm]": .numbers.base_mm}] | table
