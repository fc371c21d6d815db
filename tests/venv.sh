#!/usr/bin/env bash
# A virtual environment of Python for tests that compare with other programs: BUILD_DIR/venv, which is made where it
# is missing, with PACKAGES (NAME or NAME==VERSION, as wheels) that it lacks. Tests that run side by side share it.
# Prints the path of its Python.
#
#   tests/venv.sh BUILD_DIR PACKAGE...
#
# Ends with 77, and a line SKIP on standard error, where there is no Python with venv, or a wheel cannot be had.
set -euo pipefail
build=$1
shift
python=$build/venv/bin/python
skip() { echo "SKIP: $1" >&2; exit 77; }

command -v python3 >/dev/null || skip "no python3"
exec 9>"$build/venv.lock"
flock 9
if ! "$python" -c '' 2>/dev/null; then
    rm -rf "$build/venv"
    python3 -m venv "$build/venv" >/dev/null 2>&1 || skip "python3 makes no virtual environment (Debian: python3-venv)"
fi
missing=()
for package in "$@"; do
    "$python" - "$package" <<'PY' || missing+=("$package")
import importlib.metadata, sys
name, _, version = sys.argv[1].partition("==")
try:
    found = importlib.metadata.version(name)
except importlib.metadata.PackageNotFoundError:
    sys.exit(1)
sys.exit(bool(version) and found != version)
PY
done
if [[ ${#missing[@]} != 0 ]]; then
    said=$("$python" -m pip install --quiet --disable-pip-version-check --no-input --only-binary :all: --retries 1 \
        --timeout 30 "${missing[@]}" 2>&1 9>&-) || skip "no wheel of ${missing[*]} for $(python3 --version): ${said##*$'\n'}"
fi
echo "$python"
