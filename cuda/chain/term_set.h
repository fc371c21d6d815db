// What a scene names, as a kernel asks for it.
#pragma once

#include "solver/terms/list.h"

namespace wetcurl {

// What is there of a scene, by its place in ChainTerms; contact after them, then what others give, then
// roots that ride on a solid, then springs of a fibre. A
// kernel for one set knows it at compile time; the general one asks at each use.
namespace present {
template <class Term, size_t k = 0>
constexpr int place_of() {
    if constexpr (std::is_same_v<std::tuple_element_t<k, ChainTerms>, Slot<Term>>)
        return int(k);
    else
        return place_of<Term, k + 1>();
}
inline constexpr int contact = int(std::tuple_size_v<ChainTerms>), given = contact + 1, riding = contact + 2,
                     fibre = contact + 3;
template <class... Term>
inline constexpr unsigned these = (0u | ... | (1u << place_of<Term>()));
}  // namespace present

template <unsigned bits>
struct ExactSet {
    WETCURL_HD static constexpr bool has(int place) { return (bits >> place) & 1; }
};
struct AnySet {
    unsigned bits;
    WETCURL_HD bool has(int place) const { return (bits >> place) & 1; }
};
inline unsigned set_of(const ChainTerms& terms, bool contact, bool given, bool riding, bool fibre) {
    unsigned bits = unsigned(contact) << present::contact | unsigned(given) << present::given |
                    unsigned(riding) << present::riding | unsigned(fibre) << present::fibre;
    int place = 0;
    std::apply([&](const auto&... term) { ((bits |= unsigned(term.has_value()) << place++), ...); }, terms);
    return bits;
}
template <class Term, class Set>
WETCURL_HD bool has(const Set& set) {
    return set.has(present::place_of<Term>());
}
template <class Term>
WETCURL_HD const Term& get(const ChainTerms& terms) {
    return *std::get<present::place_of<Term>()>(terms);
}

}  // namespace wetcurl
