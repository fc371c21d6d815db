#!/usr/bin/env bash
# scripts/release refuses a version without an entry in CHANGELOG.md and a checkout with changes, and packs what the
# portable build leaves; a stand-in for that build leaves one program.
# Use: test_release.sh PROJECT
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/expect.sh"
project=$1
for needed in git cpack dpkg-deb dpkg-shlibdeps file; do
    command -v $needed >/dev/null || { echo "SKIP: $needed is not there, which makes packages"; exit 77; }
done
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
mkdir -p "$folder/scripts"
cp -r "$project/CMakeLists.txt" "$project/packaging" "$folder"
cp "$project"/scripts/{release,common.sh} "$folder/scripts"
cat >"$folder/scripts/build" <<'END'
#!/bin/sh
mkdir -p build/portable/tree/bin build/portable/tree/share/wetcurl
cp /bin/true build/portable/tree/bin/wetcurl
END
chmod +x "$folder/scripts/build"
printf '/build/\n/out/\n' >"$folder/.gitignore"
cd "$folder"
version=$(sed -nE 's/^project\(wetcurl VERSION ([0-9.]+).*/\1/p' CMakeLists.txt)
commit() { git add -A && git -c user.name=test -c user.email=test@localhost commit -qm "$1"; }
git init -q
printf '# Changelog\n\n## Unreleased\n\n- A change.\n\n## 0.0.1 - 2026-01-02\n\n- Another.\n' >CHANGELOG.md
commit first
expect 1 "no entry '## $version - YYYY-MM-DD'" scripts/release
printf '# Changelog\n\n## %s - 2026-01-03\n\n## 0.0.1 - 2026-01-02\n\n- Another.\n' "$version" >CHANGELOG.md
expect 1 "no entry" scripts/release
printf '# Changelog\n\n## %s - 2026-01-03\n\n### Added\n\n- A change.\n\n## 0.0.1 - 2026-01-02\n\n- Another.\n' "$version" >CHANGELOG.md
expect 1 "changes that no commit holds" scripts/release
commit second
expect 0 "the packages lie in" scripts/release
expect 2 "found deb without --try" "scripts/release deb"

cd out/packages
sha256sum --quiet -c "wetcurl-$version.sha256"
holds() { if grep -qx "$2" <<<"$1"; then echo "ok: holds $2"; else echo "FAILED: $2 is missing in: $1"; failures=$((failures + 1)); fi; }
holds "$(tar -tf "wetcurl-$version-linux-x86_64.tar.gz")" "wetcurl-$version-linux-x86_64/bin/wetcurl"
holds "$(tar -tf "wetcurl-$version-source.tar.gz")" "wetcurl-$version-source/REVISION"
holds "$(tar -xOf "wetcurl-$version-source.tar.gz" "wetcurl-$version-source/REVISION")" "$(git rev-parse --short=12 HEAD)"
holds "$(dpkg-deb -c "wetcurl_${version}_amd64.deb" | awk '{ print $6 }')" ./usr/bin/wetcurl
holds "$(dpkg-deb -f "wetcurl_${version}_amd64.deb" Version)" "$version"
holds "$(dpkg-deb -f "wetcurl_${version}_amd64.deb" Depends)" 'libc6.*'
exit "$((failures > 0))"
