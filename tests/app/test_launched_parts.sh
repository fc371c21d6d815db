#!/usr/bin/env bash
# Four processes that a launcher of parallel programs starts share a data set, and make the bytes that one process makes.
# Started by mpirun where it is there, else as it starts them. Use: test_launched_parts.sh WETCURL
set -euo pipefail
wetcurl=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
cat >scene.toml <<END
frames = 4
[groom]
grid = [8, 8]
particles = 24
length = 0.1
pitch = 0.04
[integrator]
substeps = 2
settle = 0
[stretch]
[bend]
[core]
[wetness]
[curl]
[cohesion]
radius = 0.03
END
cat >recipe.toml <<END
scene = "none.toml"
[splits]
train = 9
validation = 2
[draw]
"groom.length" = [0.08, 0.12]
END
make=("$wetcurl" dataset recipe.toml --scene scene.toml --threads 1 --quiet)
"${make[@]}" -o one
if command -v mpirun >/dev/null; then
    echo "by $(mpirun --version | head -n 1)"
    more=()
    [[ $(mpirun --version) != *'Open MPI'* ]] || more=(--oversubscribe)
    OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 mpirun -n 4 ${more[@]:+"${more[@]}"} "${make[@]}" -o four
else
    echo "as mpirun starts them"
    for rank in 0 1 2 3; do
        OMPI_COMM_WORLD_RANK=$rank OMPI_COMM_WORLD_SIZE=4 OMPI_COMM_WORLD_LOCAL_RANK=$rank "${make[@]}" -o four &
        processes+=($!)
    done
    for process in "${processes[@]}"; do wait "$process"; done
fi
diff -r one four
ls four
[[ -s four/train_strand.h5 && -s four/validation_strand.h5 ]]
