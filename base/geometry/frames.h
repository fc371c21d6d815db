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

// The frame turned minimally so that its first axis points along e, of any length; where e has none it stays.
template <class S>
WETCURL_HD Quat<S> transported(const Quat<S>& f, const Vec3<S>& e) {
    const Vec3<S> a = frame_direction(f);
    const S length = norm(e), along = length + dot(a, e);
    const Vec3<S> v = cross(a, e);
    Quat<S> q{select(length < S(tiny_length<S>), S(1), along), v.x, v.y, v.z};  // |e| times 1 + cos, and sin
    // A half turn goes about a perpendicular axis.
    const S opposed = S(4 * std::numeric_limits<Plain<S>>::epsilon()) * length - along;
    if (any_positive(opposed)) {
        const Vec3<S> p = any_perpendicular(a);
        q = select(opposed > S(0), Quat<S>{S(0), p.x, p.y, p.z}, q);
    }
    return normalized(q * f);
}

// The frame of a root edge: minimal rotation of the world's axes.
template <class S>
WETCURL_HD Quat<S> root_frame_of(const Vec3<S>& direction) {
    return minimal_rotation(Vec3<S>{S(1), S(0), S(0)}, direction);
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
    return renormalized(Quat<S>{f.w * cosine - f.x * sine, f.w * sine + f.x * cosine,
                                f.y * cosine + f.z * sine, f.z * cosine - f.y * sine});
}

}  // namespace wetcurl
