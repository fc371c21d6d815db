#!/usr/bin/env bash
# The schema of scenes for editors: it is what the program says, shipped scenes agree with it, and it refuses what the
# program refuses.
# Use: test_schema.sh WETCURL PROJECT. Ends with 77 where there is no Python 3.11 with jsonschema (Debian:
# python3-jsonschema, which scripts/setup --tests installs; elsewhere a virtual environment in build/python).
set -euo pipefail
wetcurl=$(realpath "$1") project=$2
python=
for one in "$project/build/python/bin/python3" python3; do
    if "$one" -c 'import jsonschema, tomllib' 2>/dev/null; then python=$one && break; fi
done
[[ -n $python ]] || { echo "SKIP: no Python 3.11 with jsonschema (see the head of this script)"; exit 77; }
"$python" "$(dirname "$0")/test_schema.py" "$wetcurl" "$project"
