// Adhesion of wet hair to solids, on a shell outside the level set.
// The paper, Eq 11 and 12; kernel after Akinci 2013. Differs: print acts inside the solid (phi < 0) and lost
// the kernel's quarter power; here the shell is h/2 < phi <= h outside, and the shape's C1 twin is the
// default (Akinci's has an infinite slope at both ends).
#pragma once

#include "solver/terms/chain.h"
#include "solver/terms/form.h"

namespace wetcurl {

struct Adhesion {
    static constexpr const char *name = "adhesion", *table = "adhesion",
                                *about = "Adhesion of wet hair to solids; needs [wetness] and a [[solid]].";
    static constexpr bool couples_two_edges = false;
    double a_max, h_a, hold;
    bool printed = false;
    static constexpr Parameter<Adhesion> parameters[] = {
        {KeyRow::number("strength", "m/s^2", 60, 0, 1e6,
                        "Largest pull on hair of saturation 1; the paper's v is strength h^3 / 0.00495.",
                        "Eq 11, a_max"),
         &Adhesion::a_max},
        {KeyRow::number("range", "m", 0.01, 1e-6, 1, "Distance from the solid beyond which wet hair is free.",
                        "Eq 12, h"),
         &Adhesion::h_a},
        {KeyRow::number("hold", "1/s", 60, 0, 1e6,
                        "Rate at which hair nearer than half the range stops sliding.", "ours"),
         &Adhesion::hold},
        {form_row, &Adhesion::printed},
    };

    // Shape with peak 1 on (1/2, 1] of q = phi/h, and its slope in q; 0 elsewhere.
    template <class S>
    WETCURL_HD static void shape(const S& q, S& value, S& slope) {
        const S x = minimum(maximum(S(2) * q - S(1), S(0)), S(1)), y = S(1) - x;
        value = S(16) * x * x * y * y;
        slope = S(64) * x * y * (y - x);
    }
    // Akinci's shape (-4 q² + 6 q - 2)^(1/4), scaled to peak 1.
    template <class S>
    WETCURL_HD static S akinci_shape(const S& q) {
        return S(1.4142135623730951) * sqrt(sqrt(maximum(S(-4) * q * q + S(6) * q - S(2), S(0))));
    }

    template <class S>
    WETCURL_HD S energy(const ChainView<S>&) const {
        return S(0);
    }

    template <class S>
    WETCURL_HD void assemble(const ChainView<S>& c, const ChainSystem<S>& a, int begin, int end) const {
        for (int i = maximum(begin, 1); i < end; ++i) {
            const S sm = c.saturation[i] * c.mass[i] * c.touching[i], scale = sm * S(a_max);
            const S q = c.phi[i] * S(1 / h_a);
            S value, slope;
            shape(q, value, slope);
            if (printed) value = akinci_shape(-q), slope = S(0);
            if (c.given_adhesion) value = -c.given_adhesion[i];
            if (!printed) {
                // No further in one step than to where it ends, however strong it is.
                const S step = a.h * a.h * S(a_max / h_a), in = maximum(q - S(0.5), S(0));
                const auto too_far = step * value > in;
                const S bound = S(1) / maximum(step, S(Plain<S>(1e-30)));
                slope = select(too_far, bound, slope);
                value = select(too_far, bound * in, value);
            }
            const Vec3<S> n = c.normal[i];
            a.force(i) -= scale * value * n;
            // Below h/2 the film holds against sliding.
            const S held = select(q < S(0.5), sm * S(hold), S(0));
            const Vec3<S> slide = c.v[i] - c.surface_velocity[i];
            a.force(i) -= held * (slide - dot(slide, n) * n);
            if (a.with_matrix()) {
                const S pull = a.h * a.h * scale * S(1 / h_a) * maximum(S(0), slope), drag = a.h * held;
                a.diagonal(i) += isotropic_plus_outer(drag, pull - drag, n);
            }
        }
    }
};

}  // namespace wetcurl
