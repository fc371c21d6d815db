# ITEM: the numbers of an item of scripts/reproduce, on each device.
include "shared";

$ARGS.positional[0] as $item | [.reproduction[$item], .reproduction["\($item)_cuda"] | values] as $made |
if $made == [] then error("results/reproduction holds no \($item).json") else . end |
# Of one result: its rows, then the rows of its tables that are a name and a value.
def numbers: [(.rows[] | {what, value: .ours}), (.tables[].rows[]? | select(has("what") and has("value")))];
[$made[0] | numbers[].what] |
map(. as $what | {"": $what} + ($made | map({(.made | device): (first(numbers[] | select(.what == $what).value) // null)}) | add)) | table
