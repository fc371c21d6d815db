# Where the numbers of each kind of hair come from.
include "shared"; include "hair";

kinds | map({kind: "`\(.hair)`", fibre: .source_of_fibre, curl: .source_of_curl}) | table
