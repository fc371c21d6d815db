// How many floating-point operations the stages of a frame take, counted by running their formulas as they
// are written, each strand and neighbour for itself.
#pragma once

#include "solver/run/simulation.h"

namespace wetcurl::bench {

// Of one particle in one substep of the chain, contact with rigid solids included: the mean over the strands
// of an implicit scene, stepped once from a state of theirs.
double chain_operations(const Scene& scene, const SimulationState& state);

// Of one particle in one pass of Eq 10 with so many neighbours.
double cohesion_operations(const Cohesion& term, double neighbours);

}  // namespace wetcurl::bench
