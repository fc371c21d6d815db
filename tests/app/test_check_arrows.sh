#!/usr/bin/env bash
# check_arrows passes a sound tree and fails each broken one, naming the file.
# Use: test_check_arrows.sh PATH/TO/check_arrows
set -euo pipefail
check=$1
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
failures=0

fresh() {
    rm -rf "${tree:?}"/*
    mkdir -p "$tree"/{base,solver/chain,solver/solids,models,learn/codec,learn/inference,training,app/commands,app/engine,tests,include/wetcurl}
    echo '#include <vector>' >"$tree/base/a.h"
    echo '#include "base/a.h"' >"$tree/solver/a.cpp"
    echo '#include <torch/torch.h>' >"$tree/models/net.h"
    echo '#include "models/net.h"' >"$tree/learn/inference/inference.cpp"
    echo '#include "learn/codec/plain.h"' >"$tree/app/main.cpp"
    echo '#include "app/commands/one.h"' >>"$tree/app/main.cpp"
    echo '#include "app/commands/one.h"' >"$tree/app/commands/one.cpp"
    echo '#include "base/a.h"' >"$tree/app/commands/one.h"
    echo '#include "base/a.h"' >"$tree/learn/codec/plain.h"
    echo '#include "solver/solids/contact.h"' >"$tree/solver/chain/step.h"
    echo '#include "base/a.h"' >"$tree/solver/solids/contact.h"
    echo '#include "wetcurl.h"' >"$tree/include/wetcurl/wetcurl.hpp"
}
expect() {  # passes|fails, file named, what is tried
    local output status=0
    output=$("$check" "$tree" 2>&1) || status=$?
    if [[ $1 == passes && $status != 0 ]] || [[ $1 == fails && $status == 0 ]] || [[ $output != *"$2"* ]]; then
        printf 'FAILED: %s: expected that it %s and names "%s"; status %d\n%s\n' "$3" "$1" "$2" "$status" "$output"
        failures=$((failures + 1))
    else
        printf 'ok: %s\n' "$3"
    fi
}

fresh
expect passes '0 wrong' 'a sound tree'
fresh; echo '#include "learn/codec/plain.h"' >>"$tree/solver/a.cpp"
expect fails 'solver/a.cpp:2' 'solver includes learn'
fresh; echo '  #  include "solver/a.h"' >>"$tree/models/net.h"
expect fails 'models/net.h:2' 'models includes solver'
fresh; echo '#include "solver/a.h"' >>"$tree/base/a.h"
expect fails 'base/a.h:2' 'base includes solver'
fresh; echo '#include <torch/script.h>' >>"$tree/solver/a.cpp"
expect fails 'solver/a.cpp:2' 'LibTorch in solver'
fresh; echo '#include "models/net.h"' >>"$tree/learn/codec/plain.h"
expect fails 'app/main.cpp:1' 'LibTorch reaches app through two headers'
fresh; echo '#include <c10/core/Device.h>' >>"$tree/learn/codec/plain.h"
expect fails 'learn/codec/plain.h:2' 'LibTorch in a header of learn'
fresh; echo '#include <fmt/format.h>' >>"$tree/base/a.h"
expect fails 'base/a.h:2' 'fmt in a header'
fresh; echo '#include <spdlog/spdlog.h>' >>"$tree/learn/inference/inference.cpp"
expect fails 'learn/inference/inference.cpp:2' 'spdlog beside LibTorch'
fresh; echo '#include "solver/chain/step.h"' >>"$tree/solver/solids/contact.h"
expect fails 'solver/solids/contact.h:2' 'two rooms include each other'
fresh; echo '#include "solver/chain/step.h"' >>"$tree/solver/b.h"; echo '#include "solver/b.h"' >>"$tree/solver/solids/contact.h"
expect fails 'solver/chain/step.h:1' 'a circle through three rooms'
fresh; echo '#include "base/a.h"' >>"$tree/include/wetcurl/wetcurl.hpp"
expect fails 'include/wetcurl/wetcurl.hpp:2' 'a public header includes base'
fresh; echo '#include "solver/a.h"' >>"$tree/tests/t.cpp"
expect passes '0 wrong' 'tests may include everything'
fresh; echo '#include "app/commands/one.h"' >"$tree/app/commands/two.cpp"
expect fails 'app/commands/two.cpp:1' 'a command uses another'
fresh; echo '#include "app/commands/one.h"' >"$tree/app/engine/loop.cpp"
expect fails 'app/engine/loop.cpp:1' 'the engine uses a command'
fresh; echo '#include "app/commands/one.h"' >>"$tree/tests/t.cpp"
expect passes '0 wrong' 'tests may use commands'
rm -rf "${tree:?}"/*
expect fails 'none of the project' 'an empty folder is not a sound tree'
exit $((failures > 0))
