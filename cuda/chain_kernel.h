// Launches of steps of all strands. Ours.
#pragma once

#include <cuda_runtime.h>

#include "cuda/strand_step.h"

namespace wetcurl {

// One launch's work: `substeps` of all strands, x and x_before (v and v_before) changing places after each.
template <class T>
struct ChainLaunch {
    StrandMemory<T> memory;
    ChainConstants<T> constants;
    const SubstepMotion<T>* motion;  // (substeps)
    int blocks, substeps;
    bool first;                   // from rest: no history
    unsigned set;                 // what is there: set_of
    unsigned long long* limited;  // edges that the limiter shortened are added to it
};
template <class T>
void launch_chain(const ChainLaunch<T>& launch, cudaStream_t stream);

// Positions out of the lanes: (strand, particle) single precision. `diverged` becomes the first strand that
// is not finite or has left the scene (ten strand lengths from its root), where there is one below it.
template <class T>
void launch_unpack(const StrandMemory<T>& memory, int strands, Vec3f* positions, int* diverged,
                   cudaStream_t stream);

}  // namespace wetcurl
