# NAME...: the file of each network, and its checksums.
include "shared"; include "models";

[models |
  {"": "`\(.name).h5`", "size [MB]": (.bytes / 1e6), "hash of the weights": "`\(.hash)`", sha256: "`\(.sha256)`"}] | table
