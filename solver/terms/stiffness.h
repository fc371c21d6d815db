// Dynamic stiffness: drag on the motion relative to the root, stronger where hair is wet.
// The paper, Eq 13. Differs: a rate c [1/s] inside the step instead of a factor a step, so that halving the
// step leaves the motion; relative to the root's rigid motion instead of the world.
#pragma once

#include "base/parameters.h"
#include "solver/terms/chain.h"

namespace wetcurl {

struct Stiffness {
    static constexpr const char *name = "stiffness", *table = "stiffness",
                                *about =
                                    "Dynamic stiffness: drag on the motion against the root, by saturation.";
    static constexpr bool couples_two_edges = false;
    double c_wet, c_dry, c_all;
    static constexpr Parameter<Stiffness> parameters[] = {
        {KeyRow::number("wet", "1/s", 0.024, 0, 1e6,
                        "Drag at saturation 1: -ln(Upsilon_0) / dt; the paper has 0.9999 at 1/240 s.",
                        "Eq 13, Upsilon_0"),
         &Stiffness::c_wet},
        {KeyRow::number("dry", "1/s", 0, 0, 1e6,
                        "Drag at saturation 0: -ln(Upsilon_1) / dt; the paper has 1, no drag.",
                        "Eq 13, Upsilon_1"),
         &Stiffness::c_dry},
        {KeyRow::number("global", "1/s", 0.0012, 0, 1e6,
                        "Drag on all hair: -ln(xi) / dt; the paper has 0.999995 at 1/240 s.", "Eq 13, xi"),
         &Stiffness::c_all},
    };

    template <class S>
    WETCURL_HD S energy(const ChainView<S>&) const {
        return S(0);
    }

    template <class S>
    WETCURL_HD void assemble(const ChainView<S>& c, const ChainSystem<S>& a, int begin, int end) const {
        for (int i = begin; i < end; ++i) {
            const S sigma = c.saturation ? c.saturation[i] : S(0);
            const S rate = S(c_all) + sigma * S(c_wet) + (S(1) - sigma) * S(c_dry);
            const Vec3<S> rigid = c.root_velocity + cross(c.root_spin, c.x[i] - c.root_center);
            a.force(i) -= rate * c.mass[i] * (c.v[i] - rigid);
            if (a.with_matrix()) add_identity(a.diagonal(i), a.h * rate * c.mass[i]);
        }
    }
};

}  // namespace wetcurl
