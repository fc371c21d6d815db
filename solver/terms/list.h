// The visible list: every term along a strand. A new one is a file and a line here.
#pragma once

#include <optional>
#include <tuple>

#include "solver/terms/adhesion.h"
#include "solver/terms/air_drag.h"
#include "solver/terms/bend.h"
#include "solver/terms/core.h"
#include "solver/terms/curl_push.h"
#include "solver/terms/stiffness.h"
#include "solver/terms/strain_limit.h"
#include "solver/terms/stretch.h"
#include "solver/terms/twist.h"

namespace wetcurl {

// The place of a term that a scene names or does not.
template <class Term>
using Slot = std::optional<Term>;

using ChainTerms = std::tuple<Slot<Stretch>, Slot<Bend>, Slot<Twist>, Slot<Core>, Slot<CurlPush>,
                              Slot<Adhesion>, Slot<Stiffness>, Slot<AirDrag>, Slot<StrainLimit>>;

// Calls f(term) for each term that the scene names, in the order of the list.
template <class Terms, class F>
WETCURL_HD void for_each_present(Terms& terms, F f) {
    std::apply([&](auto&... term) { ((term ? f(*term) : void()), ...); }, terms);
}

// The sum of the springs of each kind [N/m].
inline double spring_sum(const ChainTerms& terms) {
    double sum = 0;
    for_each_present(terms, [&](const auto& t) {
        if constexpr (requires { t.spring(); }) sum += t.spring();
    });
    return sum;
}

WETCURL_HD inline bool couples_two_edges(const ChainTerms& terms) {
    bool any = false;
    for_each_present(terms, [&](const auto& t) { any = any || t.couples_two_edges; });
    return any;
}

}  // namespace wetcurl
