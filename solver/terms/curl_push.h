// Curl exaggeration as printed: a constant push along a rotated helix, for reproducing the paper.
// The paper, Eq 7-9. Differs: taken with both signs, on i and i+1, so that it cannot thrust the strand along
// itself; Eq 9 is a length, so a stiffness makes it a force.
#pragma once

#include "base/parameters.h"
#include "solver/terms/chain.h"

namespace wetcurl {

struct CurlPush {
    static constexpr const char *name = "curl (printed)", *table = "curl";
    static constexpr bool couples_two_edges = false;
    static constexpr When when{"form", "printed"};  // of its slot too
    double k_w;
    static constexpr Parameter<CurlPush> parameters[] = {
        {KeyRow::number("push", "N/m", 0.01, 0, 1e6, "Force for each metre of the helix's edge.",
                        "Eq 9 as printed", when),
         &CurlPush::k_w},
    };

    template <class S>
    WETCURL_HD S energy(const ChainView<S>&) const {
        return S(0);
    }

    template <class S>
    WETCURL_HD void assemble(const ChainView<S>& c, const ChainSystem<S>& a, int begin, int end) const {
        const Vec3<S> x_axis{S(1), S(0), S(0)};
        const Quat<S> m = minimal_rotation(x_axis, normalized(c.chord, x_axis));
        for (int i = maximum(begin - 1, 0); i + 1 < end; ++i) a.pull(i) += S(k_w) * rotate(m, c.push[i]);
    }
};

}  // namespace wetcurl
