// Where a scene's head and solids are at the end of a substep, and how they move. Ours.
#pragma once

#include <vector>

#include "solver/passes/contact.h"
#include "solver/scene.h"

namespace wetcurl {

// In the solver's precision.
template <class T>
struct Placement {
    Pose head;
    Quat<T> root_turn;                 // rotation of the head over the substep
    Vec3<T> turn, turn_center, drift;  // the head's angular velocity, place and velocity
    std::vector<PosedSolid<T>> solids;
};

// Rotation vector of the way from one rotation to the other, over dt [rad/s].
Vec3d angular_velocity(const Quatd& before, const Quatd& after, double dt);

// At `time`, coming from where all was dt earlier. `moving` = false: all is held as it is.
template <class T>
Placement<T> placement_at(const Scene& scene, double time, double dt, bool moving = true) {
    const Pose head = scene.motion.at(time), head_before = moving ? scene.motion.at(time - dt) : head;
    Placement<T> p{head,
                   cast<T>(head.rotation * conjugate(head_before.rotation)),
                   cast<T>(angular_velocity(head_before.rotation, head.rotation, dt)),
                   cast<T>(head.translation),
                   cast<T>((1 / dt) * (head.translation - head_before.translation)),
                   {}};
    for (const auto& solid : scene.solids) {
        const Pose now = solid.at(time, head), before = moving ? solid.at(time - dt, head_before) : now;
        p.solids.push_back({&solid.shape, cast<T>(now.rotation), cast<T>(now.translation),
                            cast<T>((1 / dt) * (now.translation - before.translation)),
                            cast<T>(angular_velocity(before.rotation, now.rotation, dt)), T(solid.friction),
                            solid.attached});
    }
    return p;
}

}  // namespace wetcurl
