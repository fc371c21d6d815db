# ITEM: the rows of a learned scene that say most, on both devices.
include "shared";

$ARGS.positional[0] as $item | .reproduction[$item] as $cpu | .reproduction["\($item)_cuda"] as $gpu |
if $cpu and $gpu then . else error("results/reproduction holds no \($item).json or no \($item)_cuda.json") end |
def of($file; $words): first($file.tables[0].rows[] | select(.row | test($words))) // null;
([["wet simulation (the reference)", "^wet simulation: the reference"],
  ["wet simulation, 4 substeps, cheaper Eq 10", "^wet simulation, 4 substeps"],
  ["network `strand_m`, trained further on this scene, then Eq 10", "^network: strand_m, released, then trained"],
  ["network `strand_m_wet`, from a wet low-resolution run, then Eq 10", "^network: strand_m_wet"],
  ["network of displayed strands, trained on this scene", "^network: strand_depthwise of displayed strands"],
  ["network `displayed_m`, which never saw this scene", "^network: displayed_m"],
  ["no network: rest shapes carried, settled, then Eq 10", "settled"],
  ["no network: quad interpolation", "^quad interpolation"],
  ["the paper’s `unet_vgg19` and quad transform (width 0.25 on cores, 1 on the GPU)", "unet_vgg19.*quad transform"]] |
 map(. as [$title, $words] | of($cpu; $words) as $c | of($gpu; $words) as $g |
   {"": $title, error: ($g."unseen [mm]" | with("mm")), "of the length": ($g."of length" | with("%")), F1: $g.F1, locks: $g.locks,
    "on \($cpu.made.cores) cores": ($c."ms a frame" | with("ms")),
    "on one \($gpu.made | device)": ($g."ms a frame" | with("ms"))}) | table),
"",
"*`scripts/reproduce \($item)`: mean distance of displayed particles from the wet simulation’s on hair and motion that no training saw, F1 (the share " +
"that has one of the other run within 3 mm and 30°), locks (how dense clumps are, as a share of the simulation’s), all of the run on the " +
"GPU; and wall time of a frame, the low-resolution run included. " +
([$cpu, $gpu] | map(.made | "\(if .gpu != "none" then .gpu else .processor end), \(.date), \(.revisions | revisions)") | join("; ")) + ".*"
