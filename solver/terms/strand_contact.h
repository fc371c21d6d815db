// Contact between strands: links of places on a strand with the nearest places of others. A link pushes where
// they are nearer than it keeps them, holds by friction, and pulls where both are wet. Ours; friction after
// Cundall and Strack 1979, damping in proportion to the push after Hunt and Crossley 1975.
//
// A link of places that bear masses w (the harmonic mean of both) at a distance r along n, with the distance
// d that it keeps and q = (r - d) / radius within [0, 1], v the speed of the one as the other sees it:
//   push  p = strength x, with o = max(0, d - r) and a = soft radius: x = o^2 / (2 a) up to a, then o - a / 2
//   pull  c = cohesion sigma_i sigma_j, by 16 q^2 (1 - q)^2; what holds it H = c (1 - q)^2 (1 + 2 q)
//   F = w ((p (1 - b v.n) - c 16 q^2 (1 - q)^2 - e H v.n) n + T), |T| <= friction (p + H)
//   T = -k_t s - c_t v_t, s the slip since they touched, cut where its spring would exceed the bound.
// 1 - b v.n lies within [0, 2]; b = 1 / (radius sqrt(strength)), k_t = strength / 2, c_t and e by `damped`.
// Forces are taken where the strands are expected at the end of the substep, and are opposite and equal.
// d = min(radius, their distance in the groom as drawn); a link that begins nearer keeps what it found, and
// no less than it found since: nothing is pushed apart that was not pressed together. The potential is
//   w (P - 16 c radius (1/30 - q^3/3 + q^4/2 - q^5/5) + k_t s^2 / 2), P the integral of p.
// What friction can bear over a slip of a is the most that k_t and c_t are scaled for: friction begins
// smoothly too. Without either, a rounding decides what becomes of strands that just touch, as many do in a
// groom as drawn. Stability: forces at the expected positions gain nothing in the scheme of
// solver/chain/chain_step.h as long as L = h^2 (k + 0.6 c / h) / m is at most 1.6, k a spring and c a damper
// on m. For friction, whose slip is a sum of dt v, the spring counts 1.25 times. Strands that strike each
// other keep less: a jump of speed goes on by half of itself in BDF2. The part of a particle's L, of all its
// links together, above `most_stiff` goes on the diagonal, as an inertia: the particle follows later.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/parameters.h"
#include "base/vec3.h"

namespace wetcurl {

// What two places of strands that touch keep from step to step.
template <class S>
struct Touch {
    S kept, drawn;  // [m] d, and what it may become: min(radius, distance as drawn)
    Vec3<S> slip;   // [m] since they touched
};

struct StrandContact {
    static constexpr const char *name = "strand contact", *table = "strand_contact",
                                *about = "Contact, friction and cohesion between strands, in every substep.";
    double radius, strength, friction, cohesion;
    static constexpr Parameter<StrandContact> parameters[] = {
        {KeyRow::number("radius", "m", 0.004, 1e-5, 0.1,
                        "Distance that strands keep, unless the groom has them nearer.", "ours"),
         &StrandContact::radius},
        {KeyRow::number("strength", "1/s^2", 1e4, 0, 1e12,
                        "By how much a particle is accelerated apart for each metre that it is too near.",
                        "ours"),
         &StrandContact::strength},
        {KeyRow::number("friction", "1", 0.3, 0, 100, "Coefficient of friction of strand on strand.",
                        "Coulomb"),
         &StrandContact::friction},
        {KeyRow::number("cohesion", "m/s^2", 4, 0, 1e6,
                        "Largest acceleration by which two saturated strands that touch hold each other.",
                        "ours"),
         &StrandContact::cohesion},
    };
    // Of friction's spring against the push's; damping against what is critical for a particle.
    static constexpr float held = 0.5f, damped = 0.2f;
    // Overlap and slip, as a share of the radius, at which push and friction reach their full stiffness.
    static constexpr float soft = 0.01f;
    // What a damper's c / h and friction's spring count, against a spring on positions.
    static constexpr float of_damper = 0.6f, of_slip = 1.25f;
    // Of one step of dt [s].
    struct Step {
        float dt, radius, strength, friction, cohesion, hold, drag, bounce;
        Step(const StrandContact& c, double step)
            : dt(float(step)),
              radius(float(c.radius)),
              strength(float(c.strength)),
              friction(float(c.friction)),
              cohesion(float(c.cohesion)),
              hold(held * float(c.strength)),
              drag(2 * damped * std::sqrt(held * float(c.strength))),
              bounce(1 / (std::sqrt(maximum(float(c.strength), 1e-20f)) * float(c.radius))) {}
        WETCURL_HD float per_second() const { return 1.5f / dt; }  // 1 / h of BDF2
    };
    // On the place, by the other [N]; and how stiff that is at most, k + 0.6 c / h [N/m]. Both are zero where
    // the places do not touch.
    template <class S>
    struct Force {
        Vec3<S> force;
        S stiffness;
    };
    // d: from the other to the place, where both are expected [m]; v: its speed against it [m/s]; `wet`:
    // sigma_i sigma_j; `weight`: w [kg]. The distance that they keep and their slip follow.
    template <class S>
    WETCURL_HD static Force<S> act(const Step& step, const Vec3<S>& d, const Vec3<S>& v, const S& wet,
                                   const S& weight, Touch<S>& touch) {
        const S zero(0), one(1), two(2), strength(step.strength), bounce(step.bounce), radius(step.radius),
            dt(step.dt);
        const S of_damper(StrandContact::of_damper * step.per_second()),
            soft = S(StrandContact::soft) * radius;
        auto bounded = [&](const S& a, const S& most) { return select(a > most, most / a, one); };
        const S r = norm(d);
        touch.kept = maximum(minimum(touch.drawn, r), touch.kept);  // not NaN, should r be
        const S gap = r - touch.kept, pull = S(step.cohesion) * wet;
        const S q = minimum(maximum(gap / radius, zero), one), left = (one - q) * (one - q),
                fades = left * (one + two * q);
        const S deep = maximum(-gap, zero), steep = minimum(deep / soft, one),
                push = strength * steep * (deep - S(0.5f) * soft * steep), bears = push + pull * fades,
                most = S(step.friction) * bears;
        const S ramp = friction_ramp(S(step.hold), most, soft), hold = ramp * S(step.hold),
                drag = ramp * S(step.drag);
        const Vec3<S> n = (one / maximum(r, S(tiny_length<S>))) * d;
        const S apart = dot(v, n);
        const Vec3<S> along = v - apart * n, moved = touch.slip - dot(touch.slip, n) * n + dt * along;
        const Vec3<S> slip = bounded(hold * norm(moved), most) * moved,
                      rub = -hold * (slip + dt * along) - drag * along;
        const S kept = bounded(norm(rub), most), more = minimum(maximum(one - bounce * apart, zero), two);
        const S damping = S(2 * damped) * sqrt(S(3) * pull / radius) * fades;
        const S along_n = steep * strength * maximum(more, one) +
                          pull / radius * maximum(S(32) * q * (one - q) * (one - two * q), zero) +
                          of_damper * (push * bounce + damping);
        const S across_n = kept * (S(of_slip) * hold + of_damper * drag);
        const auto touches = bears > zero;
        const Vec3<S> none{zero, zero, zero};
        const S away = push * more - pull * S(16) * q * q * left - damping * apart;
        touch.slip = select(touches, slip, none);
        return {select(touches, weight * (away * n + kept * rub), none),
                select(touches, weight * maximum(along_n, across_n), zero)};
    }
    // Of friction's stiffness `hold`, where it bears no more than `most`.
    template <class S>
    WETCURL_HD static S friction_ramp(const S& hold, const S& most, const S& slip) {
        return minimum(most / maximum(slip * hold, S(tiny_length<S>)), S(1));
    }
    // [J] of a link with both ends a distance r apart.
    WETCURL_HD double potential(double r, double wet, double weight, const Touch<float>& touch) const {
        const double deep = maximum(double(touch.kept) - r, 0.0), full = double(soft) * radius,
                     pushed = deep < full ? deep * deep / (2 * full) : deep - full / 2,
                     pressed = deep < full ? deep * deep * deep / (3 * full)
                                           : deep * (deep - full) + full * full / 3;
        const double q = minimum(maximum((r - double(touch.kept)) / radius, 0.0), 1.0);
        const double well = 1.0 / 30 - q * q * q * (1.0 / 3 - q * (0.5 - q / 5));
        const double bears = strength * pushed + cohesion * wet * (1 - q) * (1 - q) * (1 + 2 * q),
                     hold = double(held) * strength,
                     stuck = friction_ramp(hold, friction * bears, full) * hold;
        const Vec3d slip = cast<double>(touch.slip);
        return weight * (0.5 * strength * pressed + 0.5 * stuck * dot(slip, slip) -
                         16 * cohesion * wet * radius * well);
    }
    // w of two.
    template <class T>
    WETCURL_HD static T weight(T mass, T other) {
        return 2 * mass * other / (mass + other);
    }
    // What goes on the diagonal [N/m], of the stiffness of all links of a particle: a link's relative motion
    // is as stiff as both its ends together.
    WETCURL_HD static float on_diagonal(const Step& step, float stiffness, float mass) {
        return maximum(2 * stiffness - most_stiff * mass * step.per_second() * step.per_second(), 0.f);
    }
    static constexpr float most_stiff = 4.f / 3;
    // Places of a strand that are linked, of so many particles with edges of that length at most [m]: contact
    // is smooth where they are no farther apart than the radius. No fewer than free edges: seen, where a
    // place bears the mass of several particles and hands its force to one, friction shakes coils without
    // end.
    uint32_t places(double edge, int particles) const {
        const double free = particles - 2;
        return uint32_t(
            std::clamp(std::ceil(free * edge / radius), std::max(free, 1.0), std::max(8 * free, 1.0)));
    }
    double reach(double edge) const { return std::max(2 * radius, 1.1 * std::hypot(radius, 0.5 * edge)); }
};

// The place of an edge from a to b nearest to p: how far along it, within [0, 1].
template <class S>
WETCURL_HD inline S nearest_on(const Vec3<S>& p, const Vec3<S>& a, const Vec3<S>& b) {
    const Vec3<S> e = b - a;
    const S t = dot(p - a, e) / maximum(dot(e, e), S(tiny_length<S> * tiny_length<S>));
    return minimum(maximum(t, S(0)), S(1));
}

}  // namespace wetcurl
