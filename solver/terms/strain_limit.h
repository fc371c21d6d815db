// A bound on the strain of an edge, held within the implicit step by a spring that acts beyond it alone.
// Differs from Selle 2008, which moves particles after the step: where the load alone stretches edges
// beyond the bound that feeds energy in. The explicit step keeps Selle's.
#pragma once

#include "base/parameters.h"
#include "solver/terms/chain.h"

namespace wetcurl {

struct StrainLimit {
    static constexpr const char *name = "limiter", *table = "integrator";
    static constexpr bool couples_two_edges = false;
    double most;                    // strain
    double others = 0, per_kg = 0;  // [N/m], [N/m/kg]: the spring, see `stiffness`
    static constexpr Parameter<StrainLimit> parameters[] = {
        {KeyRow::number(
             "limiter", "1", 0, 0, 10,
             "Largest strain of an edge; 0: no limit. With kind = \"explicit\" the default is 0.1.",
             "Selle 2008"),
         &StrainLimit::most},
    };

    // Beside it both inertia over a step of `dt` and the other terms' springs, summed, are soft.
    void stiffen(double dt, double spring_sum) {
        others = spring_sum;
        per_kg = 1e4 / (dt * dt);
    }
    WETCURL_HD double spring() const { return 4 * others; }
    // [N/m] of an edge whose end has `mass`.
    template <class S>
    WETCURL_HD S stiffness(const S& mass) const {
        return S(per_kg) * mass + S(spring());
    }
    template <class S>
    WETCURL_HD S excess(const S& length, const S& rest_length) const {
        return length - S(1 + most) * rest_length;
    }

    // A bound keeps none: what its spring gives back is energy from nowhere.
    template <class S>
    WETCURL_HD S energy(const ChainView<S>&) const {
        return S(0);
    }

    // Only of the implicit step, which iterates: the spring is linearised at `limit_edge`, where the edges
    // came to lie in the solve before, not at c.x. In one step an edge may turn by more than a line can tell.
    template <class S>
    WETCURL_HD void assemble(const ChainView<S>& c, const ChainSystem<S>& a, int begin, int end) const {
        if (!a.with_matrix()) return;
        for (int i = maximum(begin - 1, 1); i + 1 < end; ++i) {
            const Vec3<S> e = c.limit_edge[i], e_hat = normalized(e, Vec3<S>{S(1), S(0), S(0)});
            const S length = norm(e), d = maximum(excess(length, c.rest_length[i]), S(0));
            const S k = select(d > S(0), stiffness(c.mass[i + 1]), S(0));
            const S across = k * d / maximum(length, S(tiny_length<S>));
            const Vec3<S> back = edge(c, i) - e;
            a.pull(i) += (k * d + (k - across) * dot(e_hat, back)) * e_hat + across * back;
            const S h2 = a.h * a.h;
            a.edge(i) += isotropic_plus_outer(h2 * across, h2 * (k - across), e_hat);
        }
    }

    // Whether an edge is held at e.
    template <class S>
    WETCURL_HD auto holds(const Vec3<S>& e, const S& rest_length) const {
        return excess(norm(e), rest_length) > S(0);
    }
    // Above 0 where an edge that is held, or was, came to lie more than 1e-4 of its length from where
    // the spring was linearised.
    template <class S>
    WETCURL_HD S unsettled(const Vec3<S>& e, const Vec3<S>& at, const S& rest_length) const {
        const Vec3<S> change = e - at;
        const S moved = dot(change, change) - S(1e-8) * rest_length * rest_length;
        return select(holds(e, rest_length), moved, select(holds(at, rest_length), moved, S(0)));
    }
    static constexpr int most_solves = 20;
};

}  // namespace wetcurl
