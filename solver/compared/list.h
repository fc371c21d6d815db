// The visible list: compared methods, each in place of one part of ours: `[baseline]` chain, cohesion or
// boundary. A scene names at most one for each part. A new method is a file and a line here.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "solver/compared/boundary_particles2013.h"
#include "solver/compared/iben2013.h"
#include "solver/compared/kim2016.h"
#include "solver/compared/lin2015.h"
#include "solver/terms/list.h"

namespace wetcurl {

using Baselines = std::tuple<Slot<Iben2013>, Slot<Lin2015>, Slot<Kim2016>, Slot<BoundaryParticles2013>>;

// Calls f(method) with each method of the list, unset.
template <class F>
void for_each_baseline(F f) {
    std::apply([&](const auto&... slot) { (f(typename std::decay_t<decltype(slot)>::value_type{}), ...); },
               Baselines{});
}

// A name or a key as it reads once its part is said: "particles" for "boundary_particles".
inline const char* within_part(const std::string& part, const char* word) {
    return std::string(word).starts_with(part + "_") ? word + part.size() + 1 : word;
}

// The methods by name; the parts; the methods of one part as that part spells them.
inline std::vector<const char*> baseline_names() {
    std::vector<const char*> names;
    for_each_baseline([&](const auto& method) { names.push_back(method.name); });
    return names;
}
inline std::vector<std::string> baseline_parts() {
    std::vector<std::string> parts;
    for_each_baseline([&](const auto& method) {
        if (std::find(parts.begin(), parts.end(), method.part) == parts.end()) parts.push_back(method.part);
    });
    return parts;
}
inline std::vector<const char*> baselines_of(const std::string& part) {
    std::vector<const char*> names;
    for_each_baseline([&](const auto& method) {
        if (part == method.part) names.push_back(within_part(part, method.name));
    });
    return names;
}

// "Lin 2015 on Iben 2013's chain"; "" where none is named.
inline std::string title_of(const Baselines& baselines) {
    std::string forces, chain;
    for_each_present(baselines, [&](const auto& method) {
        if (std::string("chain") == method.part)
            chain = method.title + std::string("'s chain");
        else
            forces += (forces.empty() ? "" : " and ") + std::string(method.title);
    });
    if (forces.empty()) return chain;
    return forces + " on " + (chain.empty() ? "our chain" : chain);
}

}  // namespace wetcurl
