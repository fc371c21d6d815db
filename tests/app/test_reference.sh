#!/usr/bin/env bash
# Doxygen makes the reference of the public headers without a warning, and a name without a comment is one.
# Use: test_reference.sh PROJECT
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/expect.sh"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$1/scripts/reference" "$1/include" "$folder/reference"
grep -q wetcurl_open "$folder/reference/learned_8h.html"
cp -r "$1/include" "$folder/include"
echo 'WETCURL_API int wetcurl_uncommented(void);' >>"$folder/include/wetcurl/wetcurl.h"
expect 1 wetcurl_uncommented "'$1/scripts/reference' '$folder/include' '$folder/other'"
exit "$((failures > 0))"
