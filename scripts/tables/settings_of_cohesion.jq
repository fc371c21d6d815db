# What Eq 10 computed in full costs and gains, of scripts/settings.
include "shared";

[(.settings // {})[] | .provenance as $provenance | .hair[] | select(.kind == "wet") |
  first(.rows[] | select(.substeps == 10 and .precision == "float" and (.cohesion | not))) as $usual |
  {hair: (if .hair == "springs" then "springs (`demo.toml`)" else "`\(.hair)`" end), "error by default [% of length]": $usual.median_percent} +
  ([.rows[] | select(.cohesion and (.cohesion | has("neighbours") | not)) | (.cohesion | to_entries[0]) as $set |
    {"`\($set.key) = \($set.value)`": "\(.median_percent | short) in \(.frame_seconds / $usual.frame_seconds | short) of the time"}] | add) +
  {machine: $provenance}] | table
