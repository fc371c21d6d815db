# What pages and tables share: numbers to three digits, a list of objects to a table in Markdown, who made a result.

def short:
  if type == "number" then
    if . == 0 then "0"
    else (fabs | log10 | floor) as $e |
      if $e >= 5 then round | tostring else pow(10; 2 - $e) as $s | ((. * $s | round) / $s) | tostring end
    end
  elif type == "boolean" then (if . then "yes" else "no" end)
  elif . == null then ""
  else tostring end;
# A number with its unit, and null as it is.
def with($unit): if . == null then null else "\(short) \($unit)" end;
def percent: if . == null then null else "\(100 * . | short) %" end;

def device: if .gpu != "none" then .gpu | gsub("^NVIDIA | [0-9]+GB.*$"; "") else .processor + (if .cores then ", \(.cores) cores" else "" end) end;

# Of a value: what is an object is who made a result.
def cell: (if type == "object" then device else short end) | gsub("\\|"; "\\|");
# Of a key in a result.
def heading: sub("_mm$"; " [mm]") | gsub("_"; " ") | if . == "provenance" then "machine" else . end;
def line: "| " + (map(cell) | join(" | ")) + " |";
def rule: "|" + (map("---|") | join(""));
def table:
  if length == 0 then empty
  else (.[0] | keys_unsorted) as $k | ($k | map(heading) | line), ($k | rule), (.[] | [.[$k[]]] | line) end;
# Without the columns that no row fills, and without the rows that fill no column after the first $named.
def filled($named):
  map(to_entries) | map(select(any(.[$named:][]; .value != null))) |
  (map(.[] | select(.value != null) | .key)) as $seen |
  map(map(select(.key as $k | any($seen[]; . == $k))) | from_entries);

def minutes: if . < 90 then "\(round) s" else "\(. / 60 | short) min" end;
def made:
  "*\(.date), revision \(.revisions), \(if .gpu != "none" then .gpu + ", " else "" end)" +
  "\(.processor | gsub("^ +| +$"; "")), \(.cores) cores, \(.compiler); \(.seconds | minutes).*";
# Of a list of revisions, the first one and how many others there are.
def revisions:
  split(" ") | (length - 1) as $others |
  "revision \(.[0])" + (if $others == 0 then "" elif $others == 1 then " and 1 other" else " and \($others) others" end);

# Of the rows of a learned scene, the networks that win: no row without a network, nor the simulation, has a smaller error
# in at most 1.1 times the time. `wins`: the measures in which such a row is not better either.
def winners:
  [.[] | select(.row | startswith("network:"))] as $with | [.[] | select(.row | startswith("network:") | not)] as $without |
  def unbeaten($n; measure): ($n | measure) as $own | all($without[]; measure >= $own or ."ms a frame" > 1.1 * $n."ms a frame");
  [$with[] | . as $n | select(unbeaten($n; ."unseen [mm]")) |
    {row: (.row | ltrimstr("network: ")),
     wins: (["error"] + (if unbeaten($n; -.F1) then ["F1"] else [] end) +
            (if unbeaten($n; .locks - 1 | fabs) then ["locks"] else [] end))}];
def verdict:
  winners |
  if length == 0 then
    "**No network wins here**: for each there is a row without a network that has a smaller error on unseen hair in no more time."
  else
    "**Networks that win**, and in what (no row without a network, nor the simulation, is better in it on unseen hair in at most " +
    "1.1 times the time): " + (map("\(.row) (\(.wins | join(", ")))") | join("; ")) + "."
  end;
