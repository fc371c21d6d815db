#!/usr/bin/env bash
# A character that Blender writes walks, with hair that Blender writes; its hair goes back into Blender, which compares
# it with the skin.
#
#   test_walking_character.sh WETCURL BUILD_DIR
#
# Ends with 77 where Blender cannot be installed (tests/venv.sh).
set -euo pipefail
wetcurl=$1 build=$2
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
python=$("$here/../venv.sh" "$build" bpy) || exit $?
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$python" "$here/walking_character.py" make "$folder"
"$wetcurl" simulate "$folder/scene.toml" -o "$folder/run.h5"
"$wetcurl" export "$folder/run.h5" -o "$folder/hair.abc" --for blender
"$python" "$here/walking_character.py" check "$folder"
