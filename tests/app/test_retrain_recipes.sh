#!/usr/bin/env bash
# Each recipe of a released network makes its data set and trains its network, here a tiny one; what is there is not made
# again. Use: test_retrain_recipes.sh WETCURL PROJECT
set -euo pipefail
source "$(dirname "${BASH_SOURCE[0]}")/expect.sh"
wetcurl=$1 project=$2
export WETCURL=$wetcurl DEVICE=cpu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
# Few short strands.
for base in strands hair; do
    cat >"$base.toml" <<END
include = "$project/scenes/dataset/$base.toml"
frames = 20
[groom]
grid = [8, 8]
particles = 24
[integrator]
settle = 0
END
done
recipes=$project/models/weights/recipes
scenes=(--set data.splits.train=2 --set data.splits.validation=1)
guides=(--set 'data.low_strides=[2]' --set 'data.low_guides=[16,4]')
samples=(--set data.groom.particles=16 --set 'data.groom.grid=[4,4]' --set data.frames=40)

failed() { echo "FAILED: $*"; failures=$((failures + 1)); }
# What a recipe's training is cut to.
options_of() {
    local name=$1 how=(--set epochs=1)
    if [[ $name == displayed_scene16 ]]; then
        # its low-resolution run is of every second of its 8 x 8 roots each way
        sed "s/low_strands = .*/low_strands = 16/; s/frames = .*/frames = 10/; s|\.\./\.\./\.\./|$project/|" "$recipes/$name.toml" >"$name.toml"
        how+=(--set 'data.groom.grid=[8,8]' --set data.integrator.settle=0)
    elif grep -q '^\[\[release.scene' "$recipes/$name.toml"; then
        how+=("${samples[@]}")
    elif [[ $name == root_* ]]; then
        how+=(--set data.scene="$folder/hair.toml" "${scenes[@]}" --set batch=4)
    else
        how+=(--set data.scene="$folder/strands.toml" "${scenes[@]}" "${guides[@]}" --set batch=4)
    fi
    [[ $name == linear || $name == adhesion_* ]] || how+=(--set width=0.0625)
    printf '%s\n' "${how[@]}"
}
for recipe in "$recipes"/*.toml; do
    name=$(basename "$recipe" .toml)
    mapfile -t how < <(options_of "$name")
    [[ ! -e $name.toml ]] || recipe=$name.toml
    if ! "$wetcurl" retrain "$recipe" -o out --threads 1 --quiet "${how[@]}" >said 2>&1 || [[ ! -s out/$name.h5 ]]; then
        failed "$name: $(<said)"
        continue
    fi
    "$wetcurl" inspect model "out/$name.h5" >/dev/null || failed "$name: its model cannot be read"
    echo "ok: $name: $(tail -n 1 said)"
done
# Every released network has its recipe.
for model in "$project"/models/weights/*.h5; do
    name=$(basename "$model" .h5)
    [[ -e $recipes/$name.toml ]] || failed "$name.h5 has no recipe in models/weights/recipes"
done

# What is there stays; a seed has a file of its own, on the same scenes.
mapfile -t how < <(options_of strand_m)
before=$(stat -c '%n %Y %s' out/strand_m.h5 out/dry/manifest.json)
"$wetcurl" retrain "$recipes/strand_m.toml" -o out --threads 1 --quiet "${how[@]}" >said 2>&1 || failed "strand_m again: $(<said)"
"$wetcurl" retrain "$recipes/strand_m.toml" -o out --threads 1 --quiet --seed 7 "${how[@]}" >said 2>&1 || failed "strand_m@7: $(<said)"
[[ -s out/strand_m@7.h5 ]] || failed "there is no strand_m@7.h5"
[[ $(stat -c '%n %Y %s' out/strand_m.h5 out/dry/manifest.json) == "$before" ]] || failed "what was there was made again"
# Parts make the scenes alone, those of the network that is gone on from too.
cat >tuned.toml <<END
[release]
dataset = "$project/scenes/dataset/wet.toml"
from = "$recipes/strand_m.toml"
END
for part in 1/2 2/2; do "$wetcurl" retrain tuned.toml -o parts --threads 1 --quiet --part $part "${how[@]}" >said 2>&1 || failed "part $part: $(<said)"; done
for set in dry wet; do cmp "out/$set/manifest.json" "parts/$set/manifest.json" || failed "parts of $set are another data set"; done
[[ -z $(compgen -G 'parts/*.h5') ]] || failed "a part trained"

# One's own scene, and its network beside a model that is there: what it was made of must be the same.
own=(--set data.splits.train=2 --set data.splits.validation=1 --set 'data.draw.frames=[8,8]' --set data.first=2 --set epochs=1)
for name in my other; do sed "s/frames = 20/frames = 8/" hair.toml >$name.toml; printf '[wetness]\n[curl]\n' >>$name.toml; done
"$wetcurl" retrain "$project/scenes/dataset/tuned.toml" --scene my.toml --from "$project/models/weights/displayed_s.h5" -o own --threads 1 --quiet "${own[@]}" >said 2>&1 || failed "one's own scene: $(<said)"
"$wetcurl" retrain "$project/scenes/dataset/tuned.toml" --scene my.toml --from "$project/models/weights/displayed_s.h5" -o own --threads 1 --quiet "${own[@]}" >said 2>&1 || failed "one's own scene again: $(<said)"
expect 1 "now another is asked for" "'$wetcurl' retrain '$project/scenes/dataset/tuned.toml' --scene other.toml --from '$project/models/weights/displayed_s.h5' -o own --threads 1 --quiet ${own[*]}"
expect 1 "did not begin with" "'$wetcurl' retrain '$project/scenes/dataset/tuned.toml' --scene my.toml -o own --threads 1 --quiet ${own[*]}"
expect 2 "trains on no data set" "'$wetcurl' retrain '$recipes/displayed_scene16.toml' --scene my.toml -o none"
expect 2 "has no table [release]" "'$wetcurl' retrain '$project/scenes/demo_recipe.toml' -o none"
expect 2 "did you mean 'dataset'" "printf '[release]\ndatase = \"a.toml\"\n' >wrong.toml; '$wetcurl' retrain wrong.toml -o none"
expect 2 "found neither of dataset and [[release.scene]]" "printf '[release]\nfrom = \"a.toml\"\n' >wrong.toml; '$wetcurl' retrain wrong.toml -o none"
expect 2 "(a circle?)" "printf '[release]\ndataset = \"a.toml\"\nfrom = \"wrong.toml\"\n' >wrong.toml; '$wetcurl' retrain wrong.toml -o none"
expect 2 "found network 'strand_x', allowed: adhesion_scene15 " "'$project/scripts/retrain' none strand_x"
[[ ! -e none ]] || failed "left behind: $(ls none)"
exit $((failures > 0))
