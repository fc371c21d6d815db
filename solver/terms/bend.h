// Bending springs toward the rest shape, carried in frames along the strand.
// The paper, Eq 4 (after Iben 2013), completed to the gradient of an energy.
// Differs: print leaves out the reaction on the edge before, so its force is no gradient and feeds energy in;
// the damping acts on the rate of e_i - t_i, so that a rigid swing is free.
#pragma once

#include "solver/terms/chain.h"
#include "solver/terms/fibre.h"
#include "solver/terms/form.h"

namespace wetcurl {

struct Bend {
    static constexpr const char *name = "bend", *table = "bend",
                                *about = "Springs which turn edges back to the rest shape, and torsion.";
    static constexpr bool couples_two_edges = true;
    double k_b, c_b;
    double delay = 0;  // [s] of a fibre: its damping over its spring
    bool printed = false;
    static constexpr Parameter<Bend> parameters[] = {
        {KeyRow::number("stiffness", "N/m", 0.05, 0, 1e12,
                        "Force for each metre between an edge and its target; EI / l^3 of a beam of flexural "
                        "rigidity EI with segments of length l.",
                        "Eq 4, k_b"),
         &Bend::k_b},
        {KeyRow::number("damping", "N s/m", 5e-6, 0, 1e6,
                        "Damping of the rate at which an edge departs from its target.", "Eq 4, c_b"),
         &Bend::c_b},
        {form_row, &Bend::printed},
    };

    WETCURL_HD double spring() const { return k_b; }

    template <class S>
    WETCURL_HD static Vec3<S> target(const ChainView<S>& c, int i) {
        return rotate(c.frame[i - 1], c.target[i]);
    }

    // Squared distance of an edge from its target, turned by frame f of the edge before.
    template <class S>
    WETCURL_HD static S squared(const Quat<S>& f, const Vec3<S>& tbar, const Vec3<S>& e) {
        const Vec3<S> d = e - rotate(f, tbar);
        return dot(d, d);
    }

    template <class S>
    WETCURL_HD S energy(const ChainView<S>& c) const {
        S sum(0);
        for (int i = 1; i + 1 < c.n; ++i)
            sum += (c.bend_spring ? S(0.5) * c.bend_spring[i] : S(0.5 * k_b)) *
                   squared(c.frame[i - 1], c.target[i], edge(c, i));
        return sum;
    }

    template <class S>
    WETCURL_HD void assemble(const ChainView<S>& c, const ChainSystem<S>& a, int begin, int end) const {
        S k(k_b), damp(c_b), weight = a.h * a.h * k + a.h * damp;
        for (int i = maximum(begin - 1, 1); i + 1 < end; ++i) {
            if (c.bend_spring) {
                k = c.bend_spring[i], damp = S(delay) * k;
                weight = a.h * a.h * k + a.h * damp;
            }
            const Vec3<S> t = target(c, i), e = edge(c, i), e1 = edge(c, i - 1);
            const S inverse = S(1) / maximum(dot(e1, e1), S(tiny_length<S>));
            // How t_i turns with the edge before: dt_i = -B de_{i-1}, B = [t]x[e]x / |e|² = (e t^T - t.e I) /
            // |e|².
            const S te = dot(t, e1) * inverse;
            const Vec3<S> u = inverse * e1;
            const Vec3<S> dv = c.v[i + 1] - c.v[i], dv1 = c.v[i] - c.v[i - 1];
            const Vec3<S> strain_rate = dv + dot(t, dv1) * u - te * dv1;
            const Vec3<S> g = k * (e - t) + damp * strain_rate;
            a.pull(i) += g;
            if (!printed) a.pull(i - 1) += dot(u, g) * t - te * g;
            if (!a.with_matrix()) continue;
            const S w_te = weight * te;
            // The system takes weight A^T A of A = [B, I] on edges i-1, i.
            // B^T B = (u.u) t t^T - te (u t^T + t u^T) + te² I
            const Vec3<S> wt = weight * t, wu = w_te * u, side = dot(u, u) * t - te * u;
            const S diagonal = w_te * te;
            a.edge(i - 1) += Sym3<S>{wt.x * side.x - wu.x * t.x + diagonal,
                                     wt.x * side.y - wu.x * t.y,
                                     wt.x * side.z - wu.x * t.z,
                                     wt.y * side.y - wu.y * t.y + diagonal,
                                     wt.y * side.z - wu.y * t.z,
                                     wt.z * side.z - wu.z * t.z + diagonal};
            add_identity(a.edge(i), weight);
            // B^T = t u^T - te I
            a.joint(i) -= Mat3<S>{{wt.x * u.x - w_te, wt.x * u.y, wt.x * u.z},
                                  {wt.y * u.x, wt.y * u.y - w_te, wt.y * u.z},
                                  {wt.z * u.x, wt.z * u.y, wt.z * u.z - w_te}};
        }
    }
};

}  // namespace wetcurl
