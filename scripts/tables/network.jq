# ARCHITECTURE: times of a convolutional network: one patch, 16 patches, a step of training.
include "shared"; include "bench";

$ARGS.positional[0] as $network |
[.bench[] | machine as $machine | .entries[] | select(.name | startswith("network \($network), ")) |
  {"`\($network)`": (.name | ltrimstr("network \($network), ")), machine: $machine, time: (.milliseconds.median | with("ms")),
   "arithmetic [Tflop/s]": (if .operations then .operations / .milliseconds.median / 1e9 else null end)}] | table
