// Kernels of learn/codec/device_interpolator.h.
#pragma once

#include <cuda_runtime.h>

#include "base/vec3.h"

namespace wetcurl {

// High-resolution strands, `width` low-resolution ones around each; all arrays on the device.
struct StrandsToPlace {
    int count, particles, width;
    const Vec3f* root;    // (count) in the head's frame [m]
    const int* from;      // (count, width)
    const float* weight;  // (count, width), null: 1 each
    Quatf rotation;       // head to world
    Vec3f translation;    // [m]
};

// On the current device; positions in the world [m]. Throw Error where the launch fails.

// out (count, particles): a strand's root and the mean of the offsets in low (low strand, particles).
void launch_means(const StrandsToPlace& to, const Vec3f* low, Vec3f* out, cudaStream_t stream);
// cores (low_strands, particles) of low, as core_of.
void launch_cores(int low_strands, int particles, const Vec3f* low, Vec3f* cores, cudaStream_t stream);
// out: as launch_means of the cores, with the detail of low strand nearest[s] around its core.
void launch_details(const StrandsToPlace& to, const int* nearest, const Vec3f* low, const Vec3f* cores,
                    Vec3f* out, cudaStream_t stream);

}  // namespace wetcurl
