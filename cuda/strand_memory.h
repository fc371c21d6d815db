// The strands of a scene in a device's memory, and what kernels are told beside it. Ours.
#pragma once

#include "cuda/lanes.h"
#include "solver/passes/chain_step.h"
#include "solver/passes/contact.h"

namespace wetcurl {

// The strands in the device's memory: rows of 32 lanes (block, particle, number). Null where no present term
// needs it.
template <class T>
struct StrandMemory {
    int n;
    T *x, *x_before, *v, *v_before, *touching, *pushed;
    T* gap;            // (block, particle) from surfaces where particles were first expected
    T *frame, *ahead;  // at the positions now, and at those at which forces are taken
    T* at;             // (block, particle, 3) those positions
    T* twist;       // (block, particle, 3) what the edges' turns about themselves come from, then the turns
    T* core;        // (block, particle, 3) the core's force along each edge
    T* limit_edge;  // (block, particle, 3) edges at which the strain limit is taken
    T* change;      // (block, particle, 3) of velocities since forces were first taken in a step
    T* solution;    // (block, particle, 3) what they change by from there
    T* rows;        // (block, particle, row_size) of the system, then of its substitution
    const T *root, *mass, *rest_length, *rest_core, *target, *saturation, *rest_depth, *push;
};

// What is the same for all strands and substeps.
template <class T>
struct ChainConstants {
    ChainTerms terms;
    T dt, spring_sum, share, turn;
    int looks;  // as of a BlockStep
    Vec3<T> gravity;
};

template <class T>
using DeviceSolid = PosedSolid<T, ShapeView>;

// One substep's motion of the head and of `count` solids.
template <class T>
struct SubstepMotion {
    Quat<T> head_rotation, root_turn;
    Vec3<T> head_translation, turn, turn_center, drift;
    const DeviceSolid<T>* solids;
    int count;
    WETCURL_HD const DeviceSolid<T>* begin() const { return solids; }
    WETCURL_HD const DeviceSolid<T>* end() const { return solids + count; }
};

}  // namespace wetcurl
