# The machines of results/bench, by the names that the other tables use.
include "shared"; include "bench";

[.bench[] |
  {machine: machine, date: .provenance.date, revision: .provenance.revision, "host processor": .provenance.processor,
   compiler: .provenance.compiler, preset: .provenance.preset, "copies [GB/s]": (.machine.copy_bytes_per_second / 1e9),
   "arithmetic [Gflop/s]": (.machine.operations_per_second / 1e9)}] | table
