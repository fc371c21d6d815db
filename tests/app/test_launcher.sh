#!/usr/bin/env bash
# Which of the builds under lib/wetcurl the launcher of scripts/build portable starts. Stand-ins tell their name.
# Use: test_launcher.sh LAUNCHER
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/expect.sh"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir "$folder/bin"
cp "$1" "$folder/bin/wetcurl"
launcher=$folder/bin/wetcurl
unset WETCURL_ARCH

add() {
    local build=$folder/lib/wetcurl/$1/bin
    mkdir -p "$build"
    printf '#!/bin/sh\necho "%s of $# arguments: $*" >&2; exit 5\n' "$1" >"$build/wetcurl"
    chmod +x "$build/wetcurl"
}

flags=" $(grep -m1 '^flags' /proc/cpuinfo) "
best=x86-64-v2
[[ $flags != *" avx2 "* ]] || best=x86-64-v3
[[ $flags != *" avx512vl "* ]] || best=x86-64-v4

expect 1 "under $folder" "'$launcher'"
add x86-64-v2
expect 5 'x86-64-v2 of 2 arguments: a b c' "'$launcher' a 'b c'"
add x86-64-v3
add x86-64-v4
expect 5 "$best of 0 arguments" "'$launcher'"
expect 5 "$best of 0 arguments" "cd '$folder/bin' && PATH=.:\$PATH wetcurl"
expect 5 'x86-64-v2 of 0 arguments' "WETCURL_ARCH=x86-64-v2 '$launcher'"
expect 1 'allowed are x86-64-v2, v3 and v4' "WETCURL_ARCH=v2 '$launcher'"
[[ $best == x86-64-v4 ]] || expect 1 'found x86-64-v4, which this processor does not run' "WETCURL_ARCH=x86-64-v4 '$launcher'"
exit "$((failures > 0))"
