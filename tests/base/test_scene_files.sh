#!/usr/bin/env bash
# Other programs read the scene files that we write, and we read those that they write.
#
#   test_scene_files.sh TEST SCENE_FILE_TOOL BUILD_DIR
#
# TEST.py beside this file: alembic_with_alembic, by the Python bindings of Alembic's own library; usda_with_others, by
# Pixar's own library and tinyusdz; scene_files_with_blender, both by Blender as a Python module. Ends with 77 where these
# cannot be installed (tests/venv.sh).
set -euo pipefail
test=$1 tool=$2 build=$3
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
declare -A packages=([alembic_with_alembic]=alembic3d [scene_files_with_blender]=bpy
    [usda_with_others]="usd-core tinyusdz")
# shellcheck disable=SC2086 # several packages
python=$("$here/../venv.sh" "$build" ${packages[$test]}) || exit $?
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
PYTHONDONTWRITEBYTECODE=1 "$python" "$here/$test.py" "$tool" "$folder"
