// What steps on a device need of a scene: its numbers, and its motion substep by substep. Host only.
#pragma once

#include <vector>

#include "cuda/strand_step.h"
#include "solver/placement.h"
#include "solver/plan.h"

namespace wetcurl {

template <class T>
ChainConstants<T> chain_constants(const Scene& scene, double dt) {
    return {substep_rules<T>(scene),   T(dt),
            T(predictor_share(scene)), T(scene.integrator.turn),
            scene.integrator.looks,    cast<T>(scene.integrator.gravity)};
}

inline unsigned set_of(const Scene& scene, bool given = false) {
    return set_of(scene.chain, !scene.solids.empty(), given);
}

// The shapes of the placement's rigid and deforming solids lie in the device's memory; the motion's
// solids go to `solids`, its pointer to them is the caller's to set.
template <class T>
SubstepMotion<T> substep_motion(const Placement<T>& p, const ShapeView* shapes,
                                const ShapeView* deforming_shapes, DeviceSolid<T>* solids) {
    auto add = [&](const auto& solid, const ShapeView* shape) {
        *solids++ = {shape,      solid.rotation, solid.translation, solid.velocity,
                     solid.spin, solid.friction, solid.attached};
    };
    for (const auto& solid : p.solids) add(solid, shapes++);
    for (const auto& solid : p.deforming) add(solid, deforming_shapes++);
    return {cast<T>(p.head.rotation),
            p.root_turn,
            cast<T>(p.head.translation),
            p.turn,
            p.turn_center,
            p.drift,
            nullptr,
            int(p.solids.size() + p.deforming.size())};
}

}  // namespace wetcurl
