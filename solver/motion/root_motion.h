// How the root of a strand moves over a substep: with the head, or on its own on a mesh that deforms.
#pragma once

#include "base/vec3.h"

namespace wetcurl {

// Rotation vector of the way from one rotation to the other, over dt [rad/s].
Vec3d angular_velocity(const Quatd& before, const Quatd& after, double dt);

// S: a number, or a pack of them, a strand a lane.
template <class S>
struct RootMotion {
    Quat<S> rotation, turn;  // at the end of the substep, and over it
    Vec3<S> translation;     // at its end [m]
    Vec3<S> spin, velocity;  // of the frame of the root [rad/s], and of its origin [m/s]

    // Particle 0 or 1 in the world, from where it is in the frame of the root.
    WETCURL_HD Vec3<S> operator()(const Vec3<S>& x) const { return rotate(rotation, x) + translation; }
};

// From one pose to the other, over dt [s].
template <class T>
RootMotion<T> root_motion(const Pose& before, const Pose& now, double dt) {
    Quatd turn = now.rotation * conjugate(before.rotation);
    if (turn.w < 0) turn = {-turn.w, -turn.x, -turn.y, -turn.z};
    return {.rotation = cast<T>(now.rotation),
            .turn = cast<T>(turn),
            .translation = cast<T>(now.translation),
            .spin = cast<T>(angular_velocity(before.rotation, now.rotation, dt)),
            .velocity = cast<T>((1 / dt) * (now.translation - before.translation))};
}

template <class S, class T>
WETCURL_HD RootMotion<S> cast(const RootMotion<T>& a) {
    return {cast<S>(a.rotation), cast<S>(a.turn), cast<S>(a.translation), cast<S>(a.spin),
            cast<S>(a.velocity)};
}

}  // namespace wetcurl
