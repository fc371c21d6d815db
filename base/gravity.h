// Gravity as a scene names it: the solver reads it from [integrator], codecs from the scene of a run.
#pragma once

#include "base/parameters.h"

namespace wetcurl {

struct Gravity {
    static constexpr const char* table = "integrator";
    Vec3d gravity{0, -9.81, 0};  // [m/s^2]
    static constexpr Parameter<Gravity> parameters[] = {
        {KeyRow::numbers("gravity", "m/s^2", {0, -9.81, 0}, -1e5, 1e5, "Acceleration of gravity."),
         &Gravity::gravity},
    };
};

}  // namespace wetcurl
