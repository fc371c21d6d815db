// Which forces a scene names.
#include "solver/couplings/forces_on_strands.h"

#include "solver/passes/cohesion_forces.h"

namespace wetcurl {

std::unique_ptr<ParticleForces> make_particle_forces(const Scene& scene) {
    if (scene.cohesion && scene.cohesion->strength > 0) return make_cohesion_forces(scene);
    if (!scene.baseline) return nullptr;
    return std::visit(
        [&](const auto& method) -> std::unique_ptr<ParticleForces> {
            if constexpr (requires { method.forces(scene); }) return method.forces(scene);
            return nullptr;
        },
        *scene.baseline);
}

}  // namespace wetcurl
