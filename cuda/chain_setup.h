// What steps on a device need of a scene: its numbers, and its motion substep by substep. Host only. Ours.
#pragma once

#include <vector>

#include "cuda/strand_step.h"
#include "solver/placement.h"
#include "solver/plan.h"

namespace wetcurl {

template <class T>
ChainConstants<T> chain_constants(const Scene& scene, double dt) {
    return {scene.chain,
            T(dt),
            T(spring_sum(scene.chain)),
            T(predictor_share(scene)),
            T(scene.integrator.turn),
            scene.integrator.looks,
            cast<T>(scene.integrator.gravity)};
}

inline unsigned set_of(const Scene& scene) { return set_of(scene.chain, !scene.solids.empty()); }

// `shapes`: the scene's solids in the device's memory; the motion's solids are appended to `solids`, its
// pointer to them is the caller's to set.
template <class T>
SubstepMotion<T> substep_motion(const Placement<T>& p, const ShapeView* shapes,
                                std::vector<DeviceSolid<T>>& solids) {
    for (const auto& solid : p.solids)
        solids.push_back({shapes++, solid.rotation, solid.translation, solid.velocity, solid.spin,
                          solid.friction, solid.attached});
    return {cast<T>(p.head.rotation),
            p.root_turn,
            cast<T>(p.head.translation),
            p.turn,
            p.turn_center,
            p.drift,
            nullptr,
            int(p.solids.size())};
}

}  // namespace wetcurl
