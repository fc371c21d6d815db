// Contact between strands: particles of different strands keep their distance, and those in touch rub.
// Ours: impulses of all pairs at once (Jacobi), opposite and equal, once a substep.
//
// A pair in touch, r < d_ij = min(radius, its distance in the groom as drawn), takes
//   J = mu s (max(0, u - v_n) n - (1 - e^(-friction dt)) v_t)     [kg m/s]
//   u = (1 - e^(-strength dt)) (d_ij - r) / dt
// mu its reduced mass, s = 1 / max(contacts of i, of j), v_n and v_t its approach and its slip.
// Where u = 0 the kinetic energy changes by -sum J.v + ½ sum_i |sum_j J|² / m_i <= -½ sum s mu |v taken|²
// (Cauchy and Schwarz; no particle has more than 1/s contacts): it falls at any friction and step. u gives a
// pair no more than the speed strength radius, and leaves faster ones alone. Seen: positions moved apart
// (Mueller 2007) store a thousand times the energy in the strands' stretch, and a penalty that is limited by
// mass / dt² pumps energy wherever its limit follows the number of contacts; at a strength of 100 a head
// shake gains 2 % of the work done on it, at 1000 twice that work, and hair at rest trembles. Hence the
// range. Once a frame in place of once a substep it keeps nothing apart. The groom as drawn is free of it.
// Particles touch, not the edges between them: a radius below the segment's length lets strands slip through.
#pragma once

#include <cmath>

#include "base/parameters.h"
#include "base/vec3.h"

namespace wetcurl {

struct StrandContact {
    static constexpr const char *name = "strand contact", *table = "strand_contact",
                                *about = "Contact and friction between strands.";
    double radius, strength, friction;
    static constexpr Parameter<StrandContact> parameters[] = {
        {KeyRow::number("radius", "m", 0.006, 1e-5, 0.1,
                        "Distance that particles of two strands keep, unless the groom has them nearer.",
                        "ours"),
         &StrandContact::radius},
        {KeyRow::number("strength", "1/s", 20, 0, 50,
                        "Rate at which two particles that are nearer move apart; larger ones add energy.",
                        "ours"),
         &StrandContact::strength},
        {KeyRow::number("friction", "1/s", 5, 0, 1e9, "Rate at which the slip of two that touch dies.",
                        "ours"),
         &StrandContact::friction},
    };

    // The shares of a step of dt [s], alike for all pairs.
    struct Step {
        float parting, rubbed;  // [1/s], [1]
        Step(const StrandContact& c, double dt)
            : parting(float(-std::expm1(-c.strength * dt) / dt)),
              rubbed(float(-std::expm1(-c.friction * dt))) {}
    };
    // d_ij² of two drawn `rest` apart.
    template <class S>
    WETCURL_HD S square_distance(const Vec3<S>& rest) const {
        return minimum(S(float(radius * radius)), dot(rest, rest));
    }
    // J on i by j: d = x_i - x_j, v = v_i - v_j, `square` d_ij², mu, s. Zero where they do not touch.
    template <class S>
    WETCURL_HD static Vec3<S> impulse(const Step& step, const Vec3<S>& d, const Vec3<S>& v, const S& square,
                                      const S& mu, const S& s) {
        const S r = norm(d), least = sqrt(square), weight = select(r < least, mu * s, S(0));
        const Vec3<S> n = (S(1) / maximum(r, S(tiny_length<S>))) * d;
        const S apart = dot(v, n), taken = maximum(S(step.parting) * (least - r) - apart, S(0));
        return weight * (taken * n - S(step.rubbed) * (v - apart * n));
    }
};

}  // namespace wetcurl
