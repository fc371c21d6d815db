#!/usr/bin/env bash
# Another program reads the Alembic files that we write, and we read those that it writes.
#
#   test_alembic_with_others.sh alembic|blender SCENE_FILE_TOOL BUILD_DIR
#
# alembic: Alembic's own library, by its Python bindings; blender: Blender as a Python module. Ends with 77 where
# these cannot be installed (tests/venv.sh).
set -euo pipefail
other=$1 tool=$2 build=$3
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
declare -A package=([alembic]=alembic3d [blender]=bpy)
python=$("$here/../venv.sh" "$build" "${package[$other]}") || exit $?
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$python" "$here/alembic_with_$other.py" "$tool" "$folder"
