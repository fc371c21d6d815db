# What the scripts share: where the project lies, messages, help. Sourced, never run.
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

say() { printf '%s: %s\n' "$(basename "$0")" "$*" >&2; }
fail() { say "$*"; exit 1; }

# With --help among the arguments: prints the comment at the top of the script and ends.
help_if_asked() {
    local argument
    for argument in "$@"; do
        if [[ $argument == --help || $argument == -h ]]; then
            awk 'NR > 1 && !/^#/ { exit } NR > 1 { sub(/^# ?/, ""); print }' "$0"
            exit 0
        fi
    done
}

# program_for DEVICE: the path of WETCURL or, without it, of the build that computes there.
program_for() {
    local preset=release program
    [[ $1 == cpu ]] || preset=cuda
    program=$(realpath -m "${WETCURL:-$root/build/$preset/bin/wetcurl}")
    [[ -x $program ]] || fail "$program is not there; scripts/build $preset makes it"
    echo "$program"
}

# particles_of KINDS HAIR EACH: of a strand of scenes/kinds.toml, 0.2 m long, with so many to each turn of its curl, 64 at
# least. KINDS: what `inspect hair --json` said.
particles_of() {
    jq -r --arg hair "$2" --argjson each "$3" '.kinds[] | select(.hair == $hair) | [64, $each * 0.2 / (if .curl_radius > 0
        then ((6.283 * .curl_radius) * (6.283 * .curl_radius) + .pitch * .pitch | sqrt) else 1 end)] | max | ceil' "$1"
}

# scene_of_groom GROOM [HEAD [UNITS [UP]]]: the tables [groom] and [[solid]] of a groom on its head (m, cm or mm; y or z; else
# guessed), for a scene's end. KEYS: more keys of [groom].
scene_of_groom() {
    printf '[groom]\nfile = "%s"\nparticles = 64\n%s\n' "$(realpath "$1")" "${KEYS:-}"
    [[ -z ${3:-} ]] || printf 'units = "%s"\n' "$3"
    [[ -z ${4:-} ]] || printf 'up = "%s"\n' "$4"
    [[ -n ${2:-} ]] || return 0
    printf 'scalp = "head"\n[[solid]]\nname = "head"\nshape = "mesh"\nfile = "%s"\nattached = "head"\n' "$(realpath "$2")"
    [[ -z ${3:-} ]] || printf 'units = "%s"\n' "$3"
}

# python_with MODULE: the path of the variable PYTHON or of python3, if it has the module.
python_with() {
    local python
    python=$(command -v "${PYTHON:-python3}") && "$python" -c "import $1" 2>/dev/null || return 1
    echo "$(cd "$(dirname "$python")" && pwd)/$(basename "$python")"
}

# Jobs that processors and free memory allow: a file that includes LibTorch takes about 2 GB to compile.
jobs_that_fit() {
    awk -v cores="$(nproc)" '/^MemAvailable/ { j = int($2 / 2000000) } END { if (j > cores) j = cores; print j < 1 ? 1 : j }' \
        /proc/meminfo
}

# Threads that wait yield the core: on a loaded machine spinning costs far more than it gains.
export OMP_WAIT_POLICY=${OMP_WAIT_POLICY:-passive}
