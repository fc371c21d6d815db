// The look at the pixels around on a CUDA device: StrandMlp's depthwise convolution, its mask and its sum in
// one kernel. The reference is LibTorch's convolution (models/strand_mlp.cpp). Ours.
#pragma once

#include <cuda_runtime.h>

namespace wetcurl {

struct GridOfRows {
    int images, height, width, channels;  // channels: even
};

// out = x + depthwise 5x5 of (x mask): x, out (B H W, C), mask (B H W) or null, taps (C, 5, 5), all in half
// precision on the current device. Sums in single precision, the result is rounded once. Throws Error where
// the launch fails.
void launch_mix(const GridOfRows& grid, const void* x, const void* mask, const void* taps, void* out,
                cudaStream_t stream);

}  // namespace wetcurl
