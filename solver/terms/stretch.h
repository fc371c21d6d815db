// Stretch springs along a strand.
// The paper, Eq 1 (after Selle 2008), as printed; the Hessian is clamped so that it stays positive.
#pragma once

#include "base/parameters.h"
#include "solver/terms/chain.h"
#include "solver/terms/fibre.h"

namespace wetcurl {

struct Stretch {
    static constexpr const char *name = "stretch", *table = "stretch",
                                *about = "Springs along each strand, which keep its length.";
    static constexpr bool couples_two_edges = false;
    double k_s, c_s;
    double delay = 0;  // [s] of a fibre: its damping over its spring
    static constexpr Parameter<Stretch> parameters[] = {
        {KeyRow::number("stiffness", "N/m", 5, 0, 1e12, "Force of a segment for each metre of extension.",
                        "Eq 1, k_s"),
         &Stretch::k_s},
        {KeyRow::number("damping", "N s/m", 2e-5, 0, 1e6, "Damping of the extension, along the segment.",
                        "Eq 1, c_s"),
         &Stretch::c_s},
    };

    WETCURL_HD double spring() const { return k_s; }

    template <class S>
    WETCURL_HD S energy(const ChainView<S>& c) const {
        S sum(0);
        for (int i = 0; i + 1 < c.n; ++i) {
            S d = norm(edge(c, i)) - c.rest_length[i];
            sum += (c.stretch_spring ? S(0.5) * c.stretch_spring[i] : S(0.5 * k_s)) * d * d;
        }
        return sum;
    }

    template <class S>
    WETCURL_HD void assemble(const ChainView<S>& c, const ChainSystem<S>& a, int begin, int end) const {
        S k(k_s), damp(c_s), k_h = a.h * a.h * k, c_h = a.h * damp;
        // A segment of no length takes the direction of the one before it.
        Vec3<S> e_hat{S(1), S(0), S(0)};
        if (begin > 1) e_hat = normalized(edge(c, begin - 2), e_hat);
        for (int i = maximum(begin - 1, 0); i + 1 < end; ++i) {
            if (c.stretch_spring) {
                k = c.stretch_spring[i], damp = S(delay) * k;
                k_h = a.h * a.h * k, c_h = a.h * damp;
            }
            const Vec3<S> e = edge(c, i);
            const S length = norm(e), l = c.rest_length[i];
            const S inverse = S(1) / maximum(length, S(tiny_length<S>));
            e_hat = select(length > S(tiny_length<S>), inverse * e, e_hat);
            const S rate = dot(c.v[i + 1] - c.v[i], e_hat);
            a.pull(i) += (k * (length - l) + damp * rate) * e_hat;
            if (a.with_matrix()) {
                const S across = k_h * maximum(S(0), S(1) - l * inverse);
                a.edge(i) += isotropic_plus_outer(across, k_h + c_h - across, e_hat);
            }
        }
    }
};

}  // namespace wetcurl
