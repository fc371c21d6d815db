# The networks that win on each learned scene, and in which measures, on both devices.
include "shared";

def short_name:
  sub(", released, (never saw this scene|from the wet low-resolution run)$"; "")
  | sub(", released, then trained here, then Eq 10$"; " trained further")
  | sub(", then Eq 10$"; "")
  | sub("^strand_depthwise of displayed strands, trained here$"; "displayed strands trained here");
def where: .made | if .gpu != "none" then "on one GPU" else "on \(.cores) cores" end;

[.reproduction[] | select(any(.tables[]; .title == "Every row"))] | (map(where) | unique) as $devices | group_by(.item) |
map(. as $made | {scene: .[0].item} + ($devices | map(. as $device | {($device):
  (first($made[] | select(where == $device)) // null |
   if . == null then null else .tables[0].rows | winners | map("\(.row | short_name) (\(.wins | join(", ")))") | if length == 0 then "none" else join("; ") end end)}) | add)) |
table
