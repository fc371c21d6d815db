// Bending springs toward the rest shape, carried in frames along the strand.
// The paper, Eq 4 (after Iben 2013), completed to the gradient of an energy.
// Differs: print leaves out the reaction on the edge before, so its force is no gradient and feeds energy in;
// the damping acts on the rate of e_i - t_i, so that a rigid swing is free.
#pragma once

#include "base/parameters.h"
#include "solver/terms/chain.h"

namespace wetcurl {

struct Bend {
    static constexpr const char *name = "bend", *table = "bend";
    static constexpr bool couples_two_edges = true;
    double k_b, c_b;
    bool printed = false;
    static constexpr Parameter<Bend> parameters[] = {
        {"stiffness", &Bend::k_b, "N/m", 0.05, 0, 1e12,
         "Eq 4, k_b = EI / l^3 for a beam of flexural rigidity EI"},
        {"damping", &Bend::c_b, "N s/m", 5e-6, 0, 1e6, "Eq 4, c_b: on the rate of e_i - t_i"},
    };

    WETCURL_HD double spring() const { return k_b; }

    template <class S>
    WETCURL_HD static Vec3<S> target(const ChainView<S>& c, int i) {
        return rotate(c.frame[i - 1], c.target[i]);
    }

    // Energy of edge i for a target turned by frame f of the edge before.
    template <class S>
    WETCURL_HD S edge_energy(const Quat<S>& f, const Vec3<S>& tbar, const Vec3<S>& e) const {
        const Vec3<S> d = e - rotate(f, tbar);
        return S(0.5 * k_b) * dot(d, d);
    }

    template <class S>
    WETCURL_HD S energy(const ChainView<S>& c) const {
        S sum(0);
        for (int i = 1; i + 1 < c.n; ++i) sum += edge_energy(c.frame[i - 1], c.target[i], edge(c, i));
        return sum;
    }

    template <class S>
    WETCURL_HD void assemble(const ChainView<S>& c, const ChainSystem<S>& a, int begin, int end) const {
        const S k(k_b), damp(c_b), weight = a.h * a.h * k + a.h * damp;
        for (int i = maximum(begin - 1, 1); i + 1 < end; ++i) {
            const Vec3<S> t = target(c, i), e = edge(c, i), e1 = edge(c, i - 1);
            const S inverse = S(1) / maximum(dot(e1, e1), S(tiny_length<S>));
            // How t_i turns with the edge before: dt_i = -B de_{i-1}, B = [t]x[e]x / |e|² = (e t^T - t.e I) /
            // |e|².
            const S te = dot(t, e1) * inverse;
            const Vec3<S> u = inverse * e1;
            const Vec3<S> dv = c.v[i + 1] - c.v[i], dv1 = c.v[i] - c.v[i - 1];
            const Vec3<S> strain_rate = dv + dot(t, dv1) * u - te * dv1;
            const Vec3<S> g = k * (e - t) + damp * strain_rate;
            a.add_edge_force(i, g);
            if (!printed) a.add_edge_force(i - 1, dot(u, g) * t - te * g);
            if (!a.with_matrix()) continue;
            // A = [-B, B - I, I] on particles i-1, i, i+1; the system takes weight A^T A.
            const Mat3<S> b{{u.x * t.x - te, u.x * t.y, u.x * t.z},
                            {u.y * t.x, u.y * t.y - te, u.y * t.z},
                            {u.z * t.x, u.z * t.y, u.z * t.z - te}};
            // B^T B = (u.u) t t^T - te (u t^T + t u^T) + te² I
            const S uu = dot(u, u);
            auto btb = [&](const S& ti, const S& tj, const S& ui, const S& uj) {
                return uu * ti * tj - te * (ui * tj + ti * uj);
            };
            const S te2 = te * te;
            const Sym3<S> bb{
                weight * (btb(t.x, t.x, u.x, u.x) + te2), weight * btb(t.x, t.y, u.x, u.y),
                weight * btb(t.x, t.z, u.x, u.z),         weight * (btb(t.y, t.y, u.y, u.y) + te2),
                weight * btb(t.y, t.z, u.y, u.z),         weight * (btb(t.z, t.z, u.z, u.z) + te2)};
            a.diagonal[i - 1] += bb;
            const S two = weight + weight;
            const Sym3<S> middle{bb.xx - two * b.r0.x + weight,      bb.xy - weight * (b.r0.y + b.r1.x),
                                 bb.xz - weight * (b.r0.z + b.r2.x), bb.yy - two * b.r1.y + weight,
                                 bb.yz - weight * (b.r1.z + b.r2.y), bb.zz - two * b.r2.z + weight};
            a.diagonal[i] += middle;
            a.diagonal[i + 1] += identity_times(weight);
            const Mat3<S> bt{{weight * b.r0.x, weight * b.r1.x, weight * b.r2.x},
                             {weight * b.r0.y, weight * b.r1.y, weight * b.r2.y},
                             {weight * b.r0.z, weight * b.r1.z, weight * b.r2.z}};
            a.upper1[i - 1] -= to_mat3(bb);  // -B^T (B - I)
            a.upper1[i - 1] += bt;
            a.upper2[i - 1] -= bt;  // -B^T
            a.upper1[i] += bt;      // (B - I)^T
            a.upper1[i] -= to_mat3(identity_times(weight));
        }
    }
};

}  // namespace wetcurl
