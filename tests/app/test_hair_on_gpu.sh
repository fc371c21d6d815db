#!/usr/bin/env bash
# Hair on a GPU is that of the host: learned hair in host memory and in the GPU's, there by the example in CUDA, and hair
# that other programs simulate in memory. Follows test_library.sh, whose installation it uses.
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
# close A B FIELD LIMIT: fields of two lines, apart by at most so much.
close() { awk -v a="$1" -v b="$2" -v k="$3" -v l="$4" 'BEGIN { split(a, x, "[ ,]+"); split(b, y, "[ ,]+"); d = x[k] - y[k]; exit !(x[1] == y[1] && d * d <= l * l) }'; }
host=$("$examples/simulate_in_c") there=$("$examples/simulate_in_c" cuda)
echo "simulated in C on the host: $host; on a GPU: $there"
close "$host" "$there" 3 1e-3
host=$("$examples/simulate_in_cpp") there=$("$examples/simulate_in_cpp" cuda)
echo "simulated in C++ on the host: $host; on a GPU: $there"
close "$host" "$there" 6 1e-5  # roots on the skin
close "$host" "$there" 8 1e-3  # saturation
