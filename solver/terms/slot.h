// The place of a term, a coupling or a compared method that a scene names or does not.
#pragma once

#include <optional>
#include <type_traits>

namespace wetcurl {

// A place that is known to be empty when the program is compiled.
template <class Term>
class Never {
  public:
    using value_type = Term;
    constexpr bool has_value() const { return false; }
    constexpr explicit operator bool() const { return false; }
    Term& operator*() const { return emplace(); }
    Term* operator->() const { return &emplace(); }
    Term& emplace() const {
        static Term never;
        return never;
    }
    void reset() const {}
    void operator=(const Term&) const {}
};

template <class Term, class... Terms>
inline constexpr bool is_one_of = (std::is_same_v<Term, Terms> || ...);

// WETCURL_WITHOUT: the classes of terms that this build leaves out (CMake's option of that name).
#ifdef WETCURL_WITHOUT
template <class Term>
using Slot = std::conditional_t<is_one_of<Term, WETCURL_WITHOUT>, Never<Term>, std::optional<Term>>;
#else
template <class Term>
using Slot = std::optional<Term>;
#endif

}  // namespace wetcurl
