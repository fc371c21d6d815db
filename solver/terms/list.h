// The visible list: every term along a strand. A new one is a file and a line here.
#pragma once

#include <tuple>

#include "solver/terms/adhesion.h"
#include "solver/terms/air_drag.h"
#include "solver/terms/bend.h"
#include "solver/terms/core.h"
#include "solver/terms/curl_push.h"
#include "solver/terms/slot.h"
#include "solver/terms/stiffness.h"
#include "solver/terms/strain_limit.h"
#include "solver/terms/stretch.h"
#include "solver/terms/twist.h"

namespace wetcurl {

using ChainTerms = std::tuple<Slot<Stretch>, Slot<Bend>, Slot<Twist>, Slot<Core>, Slot<CurlPush>,
                              Slot<Adhesion>, Slot<Stiffness>, Slot<AirDrag>, Slot<StrainLimit>>;

// Calls f(term) for each term that the scene names, in the order of the list.
template <class Terms, class F>
WETCURL_HD void for_each_present(Terms& terms, F f) {
    std::apply([&](auto&... term) { ((term ? f(*term) : void()), ...); }, terms);
}
// The first ones of the list are those of nearly every hair. A loop that asks for the others again and again
// asks once whether there is any, `more`.
inline constexpr size_t common_terms = 4;
using CommonTerms = std::make_index_sequence<common_terms>;
using OtherTerms = std::make_index_sequence<std::tuple_size_v<ChainTerms> - common_terms>;
template <size_t first, class F, size_t... k>
WETCURL_HD void for_each_present_from(const ChainTerms& terms, std::index_sequence<k...>, F f) {
    ((std::get<first + k>(terms) ? f(*std::get<first + k>(terms)) : void()), ...);
}
WETCURL_HD inline bool names_more(const ChainTerms& terms) {
    bool any = false;
    for_each_present_from<common_terms>(terms, OtherTerms(), [&](const auto&) { any = true; });
    return any;
}
template <class F>
WETCURL_HD void for_each_present(const ChainTerms& terms, bool more, F f) {
    for_each_present_from<0>(terms, CommonTerms(), f);
    if (more) for_each_present_from<common_terms>(terms, OtherTerms(), f);
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
