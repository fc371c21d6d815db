// Core springs: keep the length of the smoothed strand, so that a curl does not unwind.
// The paper, Eq 5 (after Iben 2013), completed to the gradient of an energy.
// Differs: the force is carried back through the filter's adjoint; print puts it on edge i alone.
#pragma once

#include "base/geometry/filter.h"
#include "solver/terms/chain.h"
#include "solver/terms/form.h"

namespace wetcurl {

struct Core {
    static constexpr const char *name = "core", *table = "core",
                                *about = "Springs of the smoothed strand, which keep a curl from unwinding.";
    static constexpr bool couples_two_edges = false;  // its majoriser k_c D^T D
    double k_c, c_c, alpha_c;
    double beta = 1;  // of the filter, from alpha_c and the mean segment length
    bool printed = false;
    static constexpr Parameter<Core> parameters[] = {
        {KeyRow::number("stiffness", "N/m", 0.02, 0, 1e12,
                        "Force of a segment of the smoothed strand for each metre of extension.",
                        "Eq 5, k_c"),
         &Core::k_c},
        {KeyRow::number("damping", "N s/m", 5e-6, 0, 1e6, "Damping of that extension.", "Eq 5, c_c"),
         &Core::c_c},
        {KeyRow::number("smoothing", "m", 0.02, 0, 1, "Length over which the strand is smoothed.",
                        "Eq 2, alpha_c"),
         &Core::alpha_c},
        {form_row, &Core::printed},
    };

    WETCURL_HD double spring() const { return k_c; }

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

    // Force on the smoothed edge b, its rate nu.
    template <class S>
    WETCURL_HD Vec3<S> pull(const Vec3<S>& b, const Vec3<S>& nu, const S& rest) const {
        const Vec3<S> b_hat = normalized(b, Vec3<S>{S(0), S(0), S(0)});
        return (S(k_c) * (norm(b) - rest) + S(c_c) * dot(nu, b_hat)) * b_hat;
    }

    // The force along each edge, carried back through the filter.
    template <class S>
    WETCURL_HD void prepare(const ChainView<S>& c) const {
        Vec3<S>* g = c.core_pull;
        auto rate = [&](int i) { return c.v[i + 1] - c.v[i]; };
        EdgeFilter<S> edges(Plain<S>(beta), edge(c, 0)), rates(Plain<S>(beta), rate(0));
        for (int i = 0; i + 1 < c.n; ++i) g[i] = pull(edges(edge(c, i)), rates(rate(i)), c.rest_core[i]);
        if (!printed)
            smooth_edges_adjoint<S>(
                c.n - 1, Plain<S>(beta), [&](int i) { return g[i]; },
                [&](int i, const Vec3<S>& y) { g[i] = y; });
    }

    template <class S>
    WETCURL_HD void assemble(const ChainView<S>& c, const ChainSystem<S>& a, int begin, int end) const {
        const S majoriser = a.h * a.h * S(k_c) + a.h * S(c_c);
        for (int i = maximum(begin - 1, 0); i + 1 < end; ++i) {
            a.pull(i) += c.core_pull[i];
            if (a.with_matrix()) add_identity(a.edge(i), majoriser);
        }
    }
};

}  // namespace wetcurl
