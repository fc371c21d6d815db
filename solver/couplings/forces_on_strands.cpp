// Which forces a scene names.
#include "solver/couplings/forces_on_strands.h"

#include "solver/passes/cohesion_forces.h"

namespace wetcurl {

std::unique_ptr<ParticleForces> make_particle_forces(const Scene& scene) {
    std::unique_ptr<ParticleForces> forces;
    with_particle_forces(scene, [&]<class Term>(const Term& term) {
        if constexpr (std::is_same_v<Term, Cohesion>)
            forces = make_cohesion_forces(scene);
        else
            forces = term.forces(scene);
    });
    return forces;
}

}  // namespace wetcurl
