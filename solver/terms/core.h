// Core springs: keep the length of the smoothed strand, so that a curl does not unwind.
// The paper, Eq 5 (after Iben 2013), completed to the gradient of an energy.
// Differs: the force is carried back through the filter's adjoint; print puts it on edge i alone.
#pragma once

#include "base/geometry/filter.h"
#include "base/parameters.h"
#include "solver/terms/chain.h"

namespace wetcurl {

struct Core {
    static constexpr const char* name = "core";
    static constexpr bool couples_two_edges = false;  // its majoriser k_c D^T D
    double k_c, c_c, alpha_c;
    double beta = 1;  // of the filter, from alpha_c and the mean segment length
    bool printed = false;
    static constexpr Parameter<Core> parameters[] = {
        {"stiffness", &Core::k_c, "N/m", 0.02, 0, 1e12, "Eq 5, k_c"},
        {"damping", &Core::c_c, "N s/m", 5e-6, 0, 1e6, "Eq 5, c_c"},
        {"smoothing", &Core::alpha_c, "m", 0.02, 0, 1,
         "Eq 2, alpha_c: length over which the strand is smoothed"},
    };

    template <class S>
    WETCURL_HD S energy(const ChainView<S>& c) const {
        S sum(0);
        smooth_edges<S>(
            c.n - 1, Plain<S>(beta), [&](int i) { return edge(c, i); },
            [&](int i, const Vec3<S>& b) {
                S d = norm(b) - c.rest_core[i];
                sum += S(0.5 * k_c) * d * d;
            });
        return sum;
    }

    template <class S>
    WETCURL_HD void assemble(const ChainView<S>& c, const ChainSystem<S>& a) const {
        const S k(k_c), damp(c_c);
        Vec3<S>*g = c.scratch, *b = c.scratch + c.n;
        smooth_edges<S>(
            c.n - 1, Plain<S>(beta), [&](int i) { return edge(c, i); },
            [&](int i, const Vec3<S>& d) { b[i] = d; });
        const Vec3<S> none{S(0), S(0), S(0)};
        smooth_edges<S>(
            c.n - 1, Plain<S>(beta), [&](int i) { return c.v[i + 1] - c.v[i]; },
            [&](int i, const Vec3<S>& nu) {
                const Vec3<S> b_hat = normalized(b[i], none);
                g[i] = (k * (norm(b[i]) - c.rest_core[i]) + damp * dot(nu, b_hat)) * b_hat;
            });
        if (printed)
            for (int i = 0; i + 1 < c.n; ++i) a.add_edge_force(i, g[i]);
        else
            smooth_edges_adjoint<S>(
                c.n - 1, Plain<S>(beta), [&](int i) { return g[i]; },
                [&](int i, const Vec3<S>& y) { a.add_edge_force(i, y); });
        if (a.with_matrix()) {
            const Sym3<S> majoriser = identity_times(a.h * a.h * k + a.h * damp);
            for (int i = 0; i + 1 < c.n; ++i) a.add_edge_matrix(i, majoriser);
        }
    }
};

}  // namespace wetcurl
