// The visible list: compared methods, `[baseline] method`. A new one is a file and a line here.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "solver/baselines/boundary_particles2013.h"
#include "solver/baselines/iben2013.h"
#include "solver/baselines/kim2016.h"
#include "solver/baselines/lin2015.h"

namespace wetcurl {

using Baseline = std::variant<Iben2013, Lin2015, Kim2016, BoundaryParticles2013>;

// Calls f(method) with each, unset.
template <class F, size_t I = 0>
void for_each_baseline(F f) {
    if constexpr (I < std::variant_size_v<Baseline>) {
        f(std::variant_alternative_t<I, Baseline>{});
        for_each_baseline<F, I + 1>(f);
    }
}

inline std::vector<std::string> baseline_names() {
    std::vector<std::string> names;
    for_each_baseline([&](const auto& method) { names.push_back(method.name); });
    return names;
}
inline std::string name_of(const Baseline& baseline) {
    return std::visit([](const auto& method) { return std::string(method.name); }, baseline);
}

}  // namespace wetcurl
