// Curly hair as published: printed stretch, bend and core, explicit steps, no dynamic stiffness.
// Iben 2013 as the paper prints it, Eq 1-5, with Selle 2008's limits: on the strain of an edge ([integrator]
// limiter) and, here, on the velocity along it. A preset: it has no force of its own. Forces of other methods
// on wet hair join the chain's before the velocities are stepped; both limits come after.
#pragma once

#include "base/parameters.h"
#include "base/vec3.h"

namespace wetcurl {

struct Scene;

struct Iben2013 {
    static constexpr const char *name = "iben", *part = "chain", *title = "Iben 2013", *table = "baseline";
    static constexpr When named{"chain|method", "iben"};
    double dv_max;
    static constexpr Parameter<Iben2013> parameters[] = {
        {KeyRow::number("velocity_limit", "m/s", 1, 1e-6, 1e9,
                        "Largest difference of velocity along an edge.", "the text under Eq 1; Selle 2008",
                        named),
         &Iben2013::dv_max},
    };

    // Root to tip: a particle whose velocity differs by more from the one before it is slowed, and moved as
    // its step of dt would have been.
    template <class S>
    WETCURL_HD void limit_velocities(int n, Plain<S> dt, Vec3<S>* x, Vec3<S>* v) const {
        for (int i = 1; i + 1 < n; ++i) {
            const Vec3<S> dv = v[i + 1] - v[i];
            const S speed = norm(dv), kept = minimum(S(1), S(dv_max) / maximum(speed, S(tiny_length<S>)));
            const Vec3<S> change = (kept - S(1)) * dv;
            v[i + 1] += change;
            x[i + 1] += S(dt) * change;
        }
    }
};

}  // namespace wetcurl
