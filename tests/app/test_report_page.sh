#!/usr/bin/env bash
# The report's page in a browser: its script runs to the end and draws every run; a broken one is seen to fail.
# Use: test_report_page.sh WETCURL SCENE. Ends with 77 where there is no chromium.
set -euo pipefail
wetcurl=$1 scene=$2
browser=$(command -v chromium || command -v chromium-browser || true)
[[ -n $browser ]] || { echo "SKIP no chromium"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"

small=(--quiet --set "groom.grid=[8, 8]" --set groom.particles=20 --set integrator.settle=0 --frames 3)
"$wetcurl" simulate "$scene" "${small[@]}" --set 'title="</script><script>document.body.dataset.failed=1</script>"' -o wet.h5
"$wetcurl" simulate "$scene" "${small[@]}" --dry --strands 16 -o dry.h5
for method in quad rest; do "$wetcurl" infer dry.h5 --interpolate $method --quiet -o $method.h5; done
"$wetcurl" report wet.h5 quad.h5 rest.h5 --quiet -o report.html
mkdir -p table/quad
"$wetcurl" compare wet.h5 quad.h5 --quiet --json table/quad/demo.json >/dev/null
"$wetcurl" report --table table --quiet -o table.html
# A name that is not there: a script that fails must show.
sed 's/^function startPlayer/function startsPlayer/' report.html >broken.html

# The <body> tag of a page once its script ran; "" where the browser did not come that far.
body_once() {
    timeout 60 "$browser" --headless --no-sandbox --disable-gpu --disable-quic --no-first-run --disable-background-networking \
        --disable-component-update --disable-sync --user-data-dir="$folder/browser" --dump-dom "file://$folder/$1" 2>/dev/null |
        grep -o '<body[^>]*>' | head -n 1
}
# A browser that says nothing at all, as on a machine that is busy, is asked again.
body() {
    local said
    for _ in 1 2 3; do
        said=$(body_once "$1") || true
        [[ -z $said ]] || break
    done
    echo "$said"
}
failures=0
expect() {  # page, what its <body> must and must not say
    local said
    said=$(body "$1") || true
    if [[ $said != *"$2"* || $said == *"$3"* ]]; then
        echo "FAILED: $1: expected $2 and no $3, found ${said:-nothing}"
        failures=$((failures + 1))
    else
        echo "ok: $1: $said"
    fi
}
expect report.html "data-ready=\"player\"" data-failed
expect report.html "data-drawn=\"$((3 * 64 * 19))\"" data-failed  # runs, strands, edges
expect table.html "data-ready=\"page\"" data-failed
expect broken.html data-failed data-ready
exit $((failures > 0))
