// Frames along a strand: the first axis of an edge's frame is the edge's direction. Carried along the strand
// (space-parallel) or through time (time-parallel), always by the minimal rotation. Bergou 2008; Iben 2013.
#pragma once

#include "base/vec3.h"

namespace wetcurl {

template <class S>
WETCURL_HD Vec3<S> frame_direction(const Quat<S>& f) {
    return {S(1) - S(2) * (f.y * f.y + f.z * f.z), S(2) * (f.x * f.y + f.w * f.z),
            S(2) * (f.x * f.z - f.w * f.y)};
}

// The frame turned minimally so that its first axis is the unit vector `direction`.
template <class S>
WETCURL_HD Quat<S> transported(const Quat<S>& f, const Vec3<S>& direction) {
    return normalized(minimal_rotation(frame_direction(f), direction) * f);
}

// The frame of a root edge: minimal rotation of the world's axes.
template <class S>
WETCURL_HD Quat<S> root_frame_of(const Vec3<S>& direction) {
    return minimal_rotation(Vec3<S>{S(1), S(0), S(0)}, direction);
}

// Twist of `f` against `reference`, both with the same first axis: the sine and cosine of half the angle.
template <class S>
WETCURL_HD void half_twist(const Quat<S>& f, const Quat<S>& reference, S& cosine, S& sine) {
    Quat<S> d = conjugate(f) * reference;  // in f's own axes: a turn about x
    S scale = S(1) / maximum(sqrt(d.w * d.w + d.x * d.x), S(Plain<S>(1e-20)));
    auto negative = d.w < S(0);
    cosine = select(negative, -d.w, d.w) * scale;
    sine = select(negative, -d.x, d.x) * scale;
}

// The frame turned by an angle about its own first axis; angles beyond half a turn count as half a turn.
template <class S>
WETCURL_HD Quat<S> turned_about_itself(const Quat<S>& f, const S& angle) {
    const S limit(Plain<S>(3.14159265358979)), a = S(0.5) * maximum(minimum(angle, limit), -limit), q = a * a;
    // Taylor's series, exact to single precision at a quarter turn.
    auto c = [](double x) { return S(Plain<S>(x)); };
    const S sine =
        a * (S(1) - q * c(1.0 / 6) *
                        (S(1) - q * c(1.0 / 20) *
                                    (S(1) - q * c(1.0 / 42) *
                                                (S(1) - q * c(1.0 / 72) * (S(1) - q * c(1.0 / 110))))));
    const S cosine =
        S(1) -
        q * c(1.0 / 2) *
            (S(1) - q * c(1.0 / 12) *
                        (S(1) - q * c(1.0 / 30) *
                                    (S(1) - q * c(1.0 / 56) *
                                                (S(1) - q * c(1.0 / 90) * (S(1) - q * c(1.0 / 132))))));
    return normalized(f * Quat<S>{cosine, sine, S(0), S(0)});
}

}  // namespace wetcurl
