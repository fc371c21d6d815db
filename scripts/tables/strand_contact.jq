# What contact between strands costs and does, of scripts/strand_contact.
include "shared";

[(.strand_contact // {})[] | .provenance as $provenance | .rows as $rows | $rows[] |
  {machine: $provenance, "between strands": (if .contact == "with" then "contact" else "none" end),
   "ms a frame": (1000 * .frame_seconds), "times that without": (.frame_seconds / ($rows[] | select(.contact == "without").frame_seconds)),
   "particles of others within 4 mm": .pairs[0].crowd,
   "speed at rest, mean [mm/s]": .rest.mean, "99th percentile [mm/s]": .rest.p99}] | table
