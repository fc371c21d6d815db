// Contact between strands: links of a particle with the nearest places of other strands. A link pushes where
// they are nearer than it keeps them, holds by friction, and pulls where both are wet. Ours; friction after
// Cundall and Strack 1979, damping in proportion to the push after Hunt and Crossley 1975.
//
// A link of particles of mass w (the harmonic mean of both) at a distance r along n, with the distance d that
// it keeps and q = (r - d) / radius within [0, 1], v the speed of the one as the other sees it:
//   push  p = strength max(0, d - r)                      [m/s^2]
//   pull  c = cohesion sigma_i sigma_j, by 16 q^2 (1 - q)^2; what holds it H = c (1 - q)^2 (1 + 2 q)
//   F = w ((p (1 - b v.n) - c 16 q^2 (1 - q)^2 - e H v.n) n + T), |T| <= friction (p + H)
//   T = -k_t s - c_t v_t, s the slip since they touched, cut where its spring would exceed the bound.
// 1 - b v.n lies within [0, 2]; b = 2 / (radius sqrt(strength)), k_t = strength / 2, c_t and e by `damped`.
// Forces are taken where the strands are expected at the end of the substep, and are opposite and equal.
// d = min(radius, their distance in the groom as drawn); a link that begins nearer keeps what it found, and
// no less than it found since: nothing is pushed apart that was not pressed together. The potential is
//   w (strength max(0, d - r)^2 / 2 - 16 c radius (1/30 - q^3/3 + q^4/2 - q^5/5) + k_t s^2 / 2).
// Stability: an oscillator that the scheme of solver/chain/chain_step.h sees only as a force where it expects
// it gains nothing up to omega dt = 1.5. L, h^2 times what is stiffest of a particle's links by its mass:
// above `least_stiff` a sweep of Jacobi's corrects the end of the substep, which bears L <= 5; above
// `most_stiff` the rest goes on the diagonal, as an inertia: it follows later, and gains nothing.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/parameters.h"
#include "base/vec3.h"

namespace wetcurl {

// Of a place on a strand with the nearest of another.
struct StrandLink {
    static constexpr uint32_t none = ~0u;
    uint32_t other = none;      // (strand, particle) where the nearest edge of the other strand begins
    float kept = 0, drawn = 0;  // [m] d, and what it may become: min(radius, distance as drawn)
    Vec3f slip{0, 0, 0};        // [m] since they touched
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
    static constexpr float held = 0.5f, damped = 0.15f;
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
              bounce(2 / (std::sqrt(maximum(float(c.strength), 1e-20f)) * float(c.radius))) {}
        WETCURL_HD float per_second() const { return 1.5f / dt; }  // 1 / h of BDF2
    };
    // On the place, by the other [N]; and what its slopes are at most [N/m], along `normal` and across it.
    struct Force {
        Vec3f force{0, 0, 0}, normal{0, 0, 0};
        float along = 0, across = 0;
        WETCURL_HD float stiffness() const { return maximum(along, across); }
        // What holds back a change of speed [N/m m/s].
        WETCURL_HD Vec3f against(const Vec3f& speed) const {
            const Vec3f apart = dot(speed, normal) * normal;
            return along * apart + across * (speed - apart);
        }
    };
    // d: from the other to the particle, where both are expected [m]; v: its speed against it [m/s]; `wet`:
    // sigma_i sigma_j; `weight`: w [kg]. The link's distance and slip follow.
    WETCURL_HD static Force act(const Step& step, const Vec3f& d, const Vec3f& v, float wet, float weight,
                                StrandLink& link) {
        const float r = norm(d);
        link.kept = maximum(link.kept, minimum(link.drawn, r));
        const float gap = r - link.kept, pull = step.cohesion * wet;
        const float q = minimum(maximum(gap / step.radius, 0.f), 1.f), left = (1 - q) * (1 - q);
        const float push = step.strength * maximum(-gap, 0.f), hold = pull * left * (1 + 2 * q);
        const float most = step.friction * (push + hold);
        if (!(push + hold > 0)) {
            link.slip = {0, 0, 0};
            return {};
        }
        const Vec3f n = (1 / maximum(r, tiny_length<float>)) * d;
        const float apart = dot(v, n);
        const Vec3f along = v - apart * n;
        link.slip = link.slip - dot(link.slip, n) * n + step.dt * along;
        const float slip = norm(link.slip);
        if (step.hold * slip > most) link.slip = (most / (step.hold * slip)) * link.slip;
        Vec3f rub = -step.hold * (link.slip + step.dt * along) - step.drag * along;
        const float rubbed = norm(rub), kept = rubbed > most ? most / rubbed : 1;
        rub = kept * rub;
        const float more = minimum(maximum(1 - step.bounce * apart, 0.f), 2.f);
        const float damping = 2 * damped * std::sqrt(3 * pull / step.radius) * left * (1 + 2 * q);
        // What just touches, to rounding, has no slope yet.
        const bool pressed = gap < -1e-5f * step.radius;
        const float along_n = (pressed ? step.strength * maximum(more, 1.f) : 0.f) +
                              (push * step.bounce + damping) * step.per_second() +
                              pull / step.radius * maximum(32 * q * (1 - q) * (1 - 2 * q), 0.f);
        return {weight * ((push * more - pull * 16 * q * q * left - damping * apart) * n + rub), n,
                weight * along_n, weight * kept * (step.hold + step.drag * step.per_second())};
    }
    // [J] of a link with both ends a distance r apart.
    WETCURL_HD double potential(double r, double wet, double weight, const StrandLink& link) const {
        const double pressed = maximum(double(link.kept) - r, 0.0);
        const double q = minimum(maximum((r - double(link.kept)) / radius, 0.0), 1.0);
        const double well = 1.0 / 30 - q * q * q * (1.0 / 3 - q * (0.5 - q / 5));
        const Vec3d slip = cast<double>(link.slip);
        return weight * (0.5 * strength * (pressed * pressed + double(held) * dot(slip, slip)) -
                         16 * cohesion * wet * radius * well);
    }
    // w of two.
    template <class T>
    WETCURL_HD static T weight(T mass, T other) {
        return 2 * mass * other / (mass + other);
    }
    // h^2 times what is stiffest of the links of a particle, by its mass: a link's relative motion is as
    // stiff as both its ends together.
    WETCURL_HD static float stiffest(const Step& step, float stiffness, float mass) {
        return 2 * stiffness / (step.per_second() * step.per_second() * mass);
    }
    // What goes on the diagonal [N/m].
    WETCURL_HD static float on_diagonal(const Step& step, float stiffness, float mass) {
        return maximum(2 * stiffness - most_stiff * mass * step.per_second() * step.per_second(), 0.f);
    }
    // What a sweep changes a particle's speed by [m/s]: `held` what its links hold back of the speeds' change
    // [N/m m/s].
    WETCURL_HD static Vec3f correction(const Step& step, float mass, float stiffness, const Vec3f& held) {
        return (1 / (mass * step.per_second() * step.per_second() + 2 * stiffness)) * held;
    }
    // Above `least_stiff` a sweep corrects the speeds at the end of a substep; above `most_stiff` the rest
    // goes on the diagonal.
    static constexpr float least_stiff = 0.5f, most_stiff = 4;
    // Places of a particle that are linked: contact is smooth where they are no farther apart than the
    // radius.
    uint32_t places(double edge) const { return uint32_t(std::clamp(std::ceil(edge / radius), 1.0, 8.0)); }
    double reach(double edge) const { return std::max(2 * radius, 1.1 * std::hypot(radius, 0.5 * edge)); }
};

// The place of an edge from a to b nearest to p: how far along it, within [0, 1].
WETCURL_HD inline float nearest_on(const Vec3f& p, const Vec3f& a, const Vec3f& b) {
    const Vec3f e = b - a;
    const float t = dot(p - a, e) / maximum(dot(e, e), tiny_length<float> * tiny_length<float>);
    return minimum(maximum(t, 0.f), 1.f);
}

}  // namespace wetcurl
