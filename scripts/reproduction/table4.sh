# Table 4: how the time of the search for neighbours and of level sets grows (also Sec. VI.B)
# needs: cpu
# One thread: others would measure the memory, too.
make neighbour.json -- wetcurl bench --filter "neighbour search" --threads 1 --json neighbour.json
make level_sets.json -- wetcurl bench --filter "level set" --threads 1 --json level_sets.json
exponent() { jq -er --arg name "$2" '.fits[] | select(.name == $name) | .exponent' "$1" || fail "$1: no fit of '$2'"; }
row "brute force: exponent of the time in the particles" "2, O(N²)" "$(exponent neighbour.json 'neighbour search by brute force')" 1.8 2.2 "1000 to 64,000 particles"
row "uniform grid" "1, O(N)" "$(exponent neighbour.json 'neighbour search by grid')" 0.8 1.2 "1000 to 1,000,000 particles; ours"
row "k-d tree" "1 and a logarithm, O(N log N)" "$(exponent neighbour.json 'neighbour search by k-d tree')" 1.0 1.35 \
    "nanoflann; a logarithm alone adds 0.09 over these sizes, caches that no longer hold the tree the rest"
milliseconds() { jq -er --arg name "$1" '.entries[] | select(.name == $name) | .milliseconds.median' level_sets.json; }
row "VI.B: exponent of a level set's building in its nodes" "1, O(M)" \
    "$(value "log($(milliseconds 'level set build 128³') / $(milliseconds 'level set build 16³')) / log(512)")" 0.7 1.1 "16³ to 128³"
row "VI.B: queries of 64 solids over those of 1, by the tree" "a logarithm: 6 and 1" \
    "$(value "$(milliseconds 'level set query by tree, 64 solids') / $(milliseconds 'level set query by tree, 1 solids')")" 1 7 \
    "a loop over them takes $(short "$(value "$(milliseconds 'level set query by loop, 64 solids') / $(milliseconds 'level set query by loop, 1 solids')")") times as long"
numbers "Median milliseconds, about 30 neighbours a particle, every pair within reach found" \
    "$(jq -c '[.entries[] | {search: .name, milliseconds: .milliseconds.median}]' neighbour.json)"
numbers "Level sets, milliseconds" "$(jq -c '[.entries[] | {what: .name, milliseconds: .milliseconds.median}]' level_sets.json)"
