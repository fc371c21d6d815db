# What substeps and precision cost and gain, of scripts/settings.
include "shared";

def at($rows; $substeps; $precision): first($rows[] | select(.substeps == $substeps and .precision == $precision and (.cohesion | not)));
def errors($rows; $precision): [5, 10, 20, 40] | map(at($rows; .; $precision).median_percent | short) | join(", ");
[(.settings // {})[] | .provenance as $provenance | .hair[] | .rows as $rows | {
  hair: (if .hair == "springs" then "springs (`demo.toml`)" else "`\(.hair)`" end), "is": .kind,
  "error in single precision [% of length]": errors($rows; "float"),
  "in double": errors($rows; "double"),
  "frame in single [ms]": ([5, 10, 20, 40] | map(1000 * at($rows; .; "float").frame_seconds | short) | join(", ")),
  "in double, times that": (at($rows; 10; "double").frame_seconds / at($rows; 10; "float").frame_seconds),
  machine: $provenance}] | table
