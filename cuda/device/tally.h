// What the threads of a kernel have found, added up: whole numbers, whose sums have no order.
#pragma once

#include <cstdint>

namespace wetcurl {

// By whole warps; null: nobody asks.
inline __device__ void tally(uint32_t found, unsigned long long* sum) {
    if (!sum) return;
    const uint32_t of_warp = __reduce_add_sync(0xffffffffu, found);
    if (threadIdx.x % 32 == 0) atomicAdd(sum, static_cast<unsigned long long>(of_warp));
}

}  // namespace wetcurl
