// What steps on a device need of a scene: its numbers, and its motion substep by substep. Host only.
#pragma once

#include <vector>

#include "cuda/chain/strand_step.h"
#include "solver/chain/scene_checks.h"
#include "solver/solids/posed_scene.h"

namespace wetcurl {

template <class T>
ChainConstants<T> chain_constants(const Scene& scene, double dt) {
    return {.rules = substep_rules<T>(scene),
            .dt = T(dt),
            .share = T(predictor_share(scene)),
            .relinearise_angle = T(scene.integrator.relinearise_angle),
            .max_linearisations = scene.integrator.max_linearisations,
            .gravity = cast<T>(scene.integrator.gravity)};
}

inline unsigned set_of(const Scene& scene, bool given = false) {
    return set_of(scene.chain, !scene.solids.empty(), given, scene.riding.has_value(),
                  scene.fibre.has_value());
}

// The shapes of the scene's rigid and deforming solids lie in the device's memory; the motion's
// solids go to `solids`; its pointers to them and to roots that ride, here in the host's memory, are the
// caller's to set.
template <class T>
SubstepMotion<T> substep_motion(const PosedScene<T>& p, const ShapeView* shapes,
                                const ShapeView* deforming_shapes, DeviceSolid<T>* solids) {
    auto add = [&](const auto& solid, const ShapeView* shape) {
        *solids++ = {.shape = shape,
                     .rotation = solid.rotation,
                     .translation = solid.translation,
                     .velocity = solid.velocity,
                     .spin = solid.spin,
                     .friction = solid.friction,
                     .attached = solid.attached};
    };
    for (const auto& solid : p.solids) add(solid, shapes++);
    for (const auto& solid : p.deforming) add(solid, deforming_shapes++);
    return {.head = p.head_motion,
            .roots = p.roots.data(),
            .solids = nullptr,
            .count = int(p.solids.size() + p.deforming.size())};
}

}  // namespace wetcurl
