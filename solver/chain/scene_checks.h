// What a scene asks of whoever steps it, on any device, told before anything runs.
#pragma once

#include <string>
#include <vector>

#include "solver/chain/substep.h"
#include "solver/scene/scene.h"

namespace wetcurl {

// What the scene names and what it leaves out, by the names of terms and passes.
struct Presence {
    std::vector<std::string> present, absent;
};
Presence presence_of(const Scene& scene);

// The largest (h² k + h c) / m of the scene's springs and dashpots in one substep, m the mean particle's mass
// or, where that is less, the lightest one's; above 1e5 a float factorisation is not to be trusted.
double stiffness_number(const Scene& scene);
// The share of v_n in the implicit step's predictor: 1 but where core or bends are stiffer than a step can
// tell.
double predictor_share(const Scene& scene);
template <class T>
SubstepRules<T> substep_rules(const Scene& scene) {
    return {scene.chain, scene.baseline<Iben2013>(), scene.integrator.is_implicit(),
            T(spring_sum(scene.chain)), scene.fibre.has_value()};
}
// `precision`, or "double" where a float factorisation of this scene is not to be trusted.
std::string trusted_precision(const Scene& scene, const std::string& precision);

}  // namespace wetcurl
