// The energy of a strand, kind by kind: kinetic, gravity, then the present terms'. Sec. VI.I; its E_p has
// lost a square in print.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "base/pack.h"
#include "solver/terms/list.h"

namespace wetcurl {

inline constexpr int most_kinds_of_energy = 2 + int(std::tuple_size_v<ChainTerms>);

// e: of each kind [J], in each lane of the strand; returns how many kinds there are.
template <class S>
WETCURL_HD int energies(const ChainTerms& terms, const ChainView<S>& view, const Vec3<Plain<S>>& gravity,
                        S* e) {
    const Vec3<S> g = cast<S>(gravity);
    e[0] = e[1] = S(0);
    for (int i = 0; i < view.n; ++i) {
        e[0] += S(0.5) * view.mass[i] * dot(view.v[i], view.v[i]);
        e[1] -= view.mass[i] * dot(g, view.x[i]);
    }
    int kinds = 2;
    for_each_present(terms, [&](const auto& term) { e[kinds++] = term.energy(view); });
    return kinds;
}
template <class S>
std::vector<S> energies(const ChainTerms& terms, const ChainView<S>& view, const Vec3d& gravity) {
    std::vector<S> e(most_kinds_of_energy);
    e.resize(size_t(energies(terms, view, cast<Plain<S>>(gravity), e.data())));
    return e;
}
// Their names.
inline std::vector<std::string> kinds_of_energy(const ChainTerms& terms) {
    std::vector<std::string> kinds{"kinetic", "gravity"};
    for_each_present(terms, [&](const auto& t) { kinds.push_back(t.name); });
    return kinds;
}
// e (strand, kind).
template <class T>
std::vector<double> sum_over_strands(const T* e, int strands, size_t kinds) {
    std::vector<double> sum(kinds, 0);
    for (int s = 0; s < strands; ++s)
        for (size_t kind = 0; kind < kinds; ++kind) sum[kind] += double(e[size_t(s) * kinds + kind]);
    return sum;
}
// The one that is not finite, else the largest.
inline size_t largest_energy(const std::vector<double>& e) {
    size_t largest = 0;
    for (size_t kind = 0; kind < e.size(); ++kind) {
        if (!std::isfinite(e[kind])) return kind;
        if (std::abs(e[kind]) > std::abs(e[largest])) largest = kind;
    }
    return largest;
}

}  // namespace wetcurl
