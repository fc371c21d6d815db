// Launches of forces on all strands at once.
#pragma once

#include <cuda_runtime.h>

#include <variant>

#include "cuda/chain/strand_memory.h"
#include "cuda/pair_forces/pair_forces_kernel_body.h"

namespace wetcurl {

using AnyPulls =
    std::variant<StrandPulls<CohesionPairs>, StrandPulls<LinPairs>, StrandPulls<KimPairs>, BoundaryPulls>;

// x (strand, particle) [m]: where the scheme expects particles; where they are without one. `near`: the same
// from the first particle; null: nobody asks.
template <class T>
void launch_sight(const StrandMemory<T>& memory, const Bdf2<T>* scheme, Vec3d* x, Vec3f* near,
                  cudaStream_t stream);
// The points of a search of `near` that is done.
void launch_points(const PairMemory& memory, const Vec3d* x, const double* mass, const float* saturation,
                   cudaStream_t stream);
// Whether what is there is replaced, or added to.
enum class Write { new_values, added };
// -> force [N], stiffness [N/m] (null: none) (strand, particle). Pairs are added to `pairs`, unless it is
// null.
template <class T>
void launch_pulls(const AnyPulls& pulls, Write write, Vec3<T>* force, T* stiffness, unsigned long long* pairs,
                  cudaStream_t stream);
// -> parts (energy_parts) [J], whose sum is the potential.
size_t energy_parts(size_t particles);
void launch_energies(const AnyPulls& pulls, Write write, double* parts, cudaStream_t stream);

}  // namespace wetcurl
