# The steps of a shot and their times, of `scripts/shot`.
include "shared";

def time: if . < 10 then "\(. * 10 | round / 10) s" else minutes end;
.shot.shot.steps |
[.[] | {step, command: (if .command == "" then "Blender" else "`\(.command)`" end), time: (.seconds | time)}] +
[{step: "all of it", command: "", time: (map(.seconds) | add | minutes)}] | table
