// Cohesion inside the solve: Eq 10's sum over wet neighbours as forces with a potential, in every substep.
// The paper, Sec. VI.A.2, which sub-iterates the solve for it, ten times a frame. Differs: each pair's pull
// is the same on both, so that it is the gradient of an energy; Eq 10's own division is not, and trembles.
#pragma once

#include <memory>

#include "solver/pair_forces/pair_forces.h"

namespace wetcurl {

inline constexpr const char* cohesion_in_the_solve = "cohesion in the solve";

// For a scene with [cohesion] of some strength, which must outlive it.
std::unique_ptr<PairForces> make_cohesion_forces(const Scene& scene);

}  // namespace wetcurl
