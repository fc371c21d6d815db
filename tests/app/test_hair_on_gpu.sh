#!/usr/bin/env bash
# Learned hair on a GPU is that of the host, in host memory and in the GPU's: there by the example in CUDA. Follows
# test_library.sh, whose installation it uses.
# Use: test_hair_on_gpu.sh BUILD MODEL OTHER           OTHER: of strands before cohesion, so that Eq 10 is computed there too
set -euo pipefail
folder=$1/installed examples=$1/installed/examples
shift
skip() { echo "SKIP: $1"; exit 77; }
[[ -x $examples/hair_on_gpu ]] || skip "no nvcc, which compiles the example"
"$folder/prefix/bin/wetcurl" inspect device --json - | grep -A1 '"cuda_devices"' | grep -qE '^ +"[^"]+"$' ||
    skip "no GPU, or a build without CUDA"
for model in "$@"; do
    host=$("$examples/hair_in_c" "$folder/scene.toml" "$model")
    from_host=$("$examples/hair_in_c" "$folder/scene.toml" "$model" cuda)
    in_place=$("$examples/hair_on_gpu" "$folder/scene.toml" "$model")
    echo "on the host: $host; on a GPU: $from_host; in its memory: $in_place"
    # Networks compute in half precision there: within 1 mm.
    for there in "$from_host" "$in_place"; do
        awk -v a="$host" -v b="$there" 'BEGIN { split(a, x, ", "); split(b, y, ", "); d = x[2] - y[2]; exit !(x[1] == y[1] && d * d < 1e-6) }'
    done
done
