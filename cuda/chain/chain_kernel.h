// Launches of steps of all strands.
#pragma once

#include <cuda_runtime.h>

#include "cuda/chain/strand_step.h"

namespace wetcurl {

// How strands are shared out among blocks of threads.
struct StrandGroup {
    int strands;   // of each block
    size_t bytes;  // of workspace for it
    bool near;     // in the processor's own memory
};
template <class T>
StrandGroup strand_group(int n, int strands, const ChainTerms& terms);

// One launch's work: `substeps` of all strands.
template <class T>
struct ChainLaunch {
    StrandMemory<T> memory;
    ChainConstants<T> constants;
    const SubstepMotion<T>* motion;  // (substeps)
    int substeps;
    bool first, always_first;     // from rest: no history; each substep goes without
    unsigned set;                 // what is there: set_of
    unsigned long long* limited;  // edges that the limiter shortened are added to it
    T* workspace;                 // group.bytes of each block where strands are not near, else null
    StrandGroup group;
    WETCURL_HD bool riding() const { return (set >> present::riding) & 1; }
    WETCURL_HD bool is_first(int substep) const { return always_first || (first && substep == 0); }
};
template <class T>
void launch_chain(const ChainLaunch<T>& launch, cudaStream_t stream);

// Calls f(set). Common sets have kernels of their own, with nothing in them of what is absent.
template <class F>
void with_set(unsigned set, F f) {
    using namespace present;
    constexpr unsigned dry = these<Stretch, Bend, Twist, Core>,
                       wet = these<Stretch, Bend, Twist, Core, Stiffness>, solid = 1u << contact;
    if (set == dry) return f(ExactSet<dry>());
    if (set == (wet | solid)) return f(ExactSet<wet | solid>());
    // Of fibres, which have no core.
    constexpr unsigned fibre_dry = these<Stretch, Bend, Twist> | 1u << fibre,
                       fibre_wet = these<Stretch, Bend, Twist, Stiffness> | 1u << fibre | solid;
    if (set == fibre_dry) return f(ExactSet<fibre_dry>());
    if (set == fibre_wet) return f(ExactSet<fibre_wet>());
    f(AnySet{set});
}

// The same by the CPU's own pass, a thread a strand: the other's reference, and whatever that does not cover.
// `workspace`: reference_workspace of each strand.
template <class T>
size_t reference_workspace(int n, const SubstepRules<T>& rules, bool contact);
template <class T>
void launch_reference(const ChainLaunch<T>& launch, cudaStream_t stream);

// The surface nearest to each particle, (strand, particle), as adhesion sees it at the end of a substep's
// `motion`; far away, with a normal upwards, where there is none.
template <class T>
void launch_nearest(const StrandMemory<T>& memory, const SubstepMotion<T>* motion, T* phi, Vec3<T>* normal,
                    Vec3<T>* velocity, cudaStream_t stream);

// Positions in single precision. `diverged` becomes the first strand that is not finite or has left the scene
// (ten strand lengths from its root), where there is one below it.
template <class T>
void launch_unpack(const StrandMemory<T>& memory, Vec3f* positions, int* diverged, cudaStream_t stream);

}  // namespace wetcurl
