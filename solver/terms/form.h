// Which form of a term a scene asks for.
#pragma once

#include "base/parameters.h"

namespace wetcurl {

inline constexpr const char* forms[] = {"variational", "printed"};
inline constexpr KeyRow form_row = KeyRow::one_of(
    "form", forms, "variational",
    "The force is the gradient of an energy (variational), or what the paper prints (printed).");

}  // namespace wetcurl
