// What the threads of a kernel have found, added up: whole numbers, whose sums have no order, or numbers of a
// block, always in the same one.
#pragma once

#include <cstdint>

namespace wetcurl {

// By whole warps; null: nobody asks.
inline __device__ void tally(uint32_t found, unsigned long long* sum) {
    if (!sum) return;
    const uint32_t of_warp = __reduce_add_sync(0xffffffffu, found);
    if (threadIdx.x % 32 == 0) atomicAdd(sum, static_cast<unsigned long long>(of_warp));
}

// To `sum`, of all threads of a block, so many.
template <unsigned threads>
__device__ void sum_of_block(double value, double* sum) {
    __shared__ double of[threads];
    of[threadIdx.x] = value;
    for (unsigned half = threads / 2; half > 0; half /= 2) {
        __syncthreads();
        if (threadIdx.x < half) of[threadIdx.x] += of[threadIdx.x + half];
    }
    if (threadIdx.x == 0) *sum = of[0];
}

}  // namespace wetcurl
