// A parameter table: each row names a key, its unit, default, range and source, and the member it fills.
// One table serves reading a scene, `inspect terms`, error messages and the tests that walk it.
#pragma once

#include <limits>

#include "base/config.h"

namespace wetcurl {

inline constexpr double unbounded = std::numeric_limits<double>::infinity();

template <class Owner>
struct Parameter {
    const char* key;
    double Owner::*member;
    const char* unit;
    double fallback, minimum, maximum;
    const char* meaning;  // with the source: "Eq 1, k_s"
};

// Fills every member from `table`, or with its default where the key is absent.
template <class Owner, size_t N>
void read_parameters(Owner& owner, const Parameter<Owner> (&rows)[N], Table table) {
    for (const auto& row : rows)
        owner.*row.member = table.number(row.key, row.fallback, row.minimum, row.maximum);
}

}  // namespace wetcurl
