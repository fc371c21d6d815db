# Of a released model, as `wetcurl inspect model` prints it, with name, bytes and sha256.
include "shared";

# Those that the marker of the table names.
def models:
  .models as $all | $ARGS.positional[] |
  $all[.] // error("models/weights holds no \(.).h5; it holds \($all | keys | join(" "))");
def recipe($key): (.recipe | capture("(^|\n)\($key) = (?<v>[^\n]*)").v | gsub("\""; "")) // "";
# The files that it was trained on, without their hashes.
def trained_on: .trained_on | split("\n") | map(sub(" [0-9a-f]{16}"; "")) | join("; ");
