// The inputs of a network in Eq 11's place for a particle, and when its output holds: for any device.
#pragma once

#include <cmath>

#include "base/network_channels.h"
#include "solver/terms/adhesion.h"

namespace wetcurl {

// A particle as its own inputs and its neighbours' have it.
template <class T>
struct AdhesionParticle {
    T touching, phi;  // phi [m] of the surface nearest to it
    Vec3<T> v;        // [m/s]
    float answer;     // F.n / (sigma m a_max) of the step before
};

struct AdhesionFeatures {
    static constexpr int inputs = adhesion_inputs;
    double range, speed;  // h_a [m], 1 / sqrt(a_max h_a) [s/m]
    explicit AdhesionFeatures(const Adhesion& term)
        : range(term.h_a), speed(1 / std::sqrt(term.a_max * term.h_a)) {}

    // Only wet particles near a surface are asked about.
    template <class T>
    WETCURL_HD bool concerns(const T& saturation, const T& phi) const {
        return saturation > 0 && !(phi > 2 * range);
    }
    // AdhesionChannels of particles i-1, i, i+1 of a strand of n, of the last one twice at its end -> to
    // (inputs). `normal` and `surface_velocity` of the surface nearest to i; seen(j) -> AdhesionParticle.
    template <class T, class Seen>
    WETCURL_HD void ask(int i, int n, const Vec3<T>& normal, const Vec3<T>& surface_velocity, Seen seen,
                        float* to) const {
        for (int side = -1; side <= 1; ++side) {
            const AdhesionParticle<T> p = seen(i + side < n ? i + side : i);
            float* const of = to + AdhesionChannels::first(side);
            of[AdhesionChannels::contact] = float(p.touching);
            of[AdhesionChannels::speed] = float(dot(p.v - surface_velocity, normal) * speed);
            of[AdhesionChannels::distance] = float(minimum(T(4), p.phi / T(range)));
            of[AdhesionChannels::force] = p.answer;
        }
    }
    // Whether the answer holds; where not, nothing pulls.
    template <class T>
    WETCURL_HD static bool in_contact(const T& touching) {
        return touching > 0;
    }
};

}  // namespace wetcurl
