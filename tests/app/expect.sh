# What the tests of programs share. Sourced, never run.
failures=0

expect() {  # status, what standard error holds, what is tried (run as a command of bash)
    local status=0 said
    said=$(bash -c "$3" 2>&1 >/dev/null) || status=$?
    if [[ $status != "$1" || $said != *"$2"* ]]; then
        printf 'FAILED: %s: expected status %s and "%s"; status %s\n%s\n' "$3" "$1" "$2" "$status" "$said"
        failures=$((failures + 1))
    else
        printf 'ok: %s\n' "$3"
    fi
}
