// StrandMlp on a CUDA device in half precision: what stands between its matrix products, each in one kernel.
// The reference is models/strand_mlp.cpp, in which LibTorch does it.
#pragma once

#include <cuda_runtime.h>

namespace wetcurl {

struct GridOfRows {
    int images, height, width, channels;  // channels: a multiple of 8
};

// All on the current device; sums in single precision but those of up to 15 taps, results are rounded once,
// and so is what a look around sees where it is masked or ends. Throw Error where the launch fails.

// rows (B H W, channels) in half precision = (image - mean) share, at most `most` either way; image (B,
// inputs, H, W), mean and share (inputs) in single precision; inputs <= channels, beyond them 0. mask (B
// H W) or null: 0 where all of a pixel's inputs are 0, else 1.
void launch_normalise(const GridOfRows& grid, int inputs, const float* image, const float* mean,
                      const float* share, float most, void* rows, void* mask, cudaStream_t stream);

// out = y + depthwise 5x5 of (y mask) with y = x + shift: x, out (B H W, C), mask (B H W) or null, taps (5,
// 5, C) in half precision, shift (C) and lift (C) = shift (1 + sum of taps) in single precision.
void launch_mix(const GridOfRows& grid, const void* x, const void* mask, const void* taps, const float* shift,
                const float* lift, void* out, cudaStream_t stream);

// What a last layer takes: out (count, channels + beside_activated) = share_activated relu(x + shift), then
// 1, 1, for a bias in two halves, and 0; x (count, C) and out in half precision, shift (C) in single. The
// share leaves weights of small outputs far above the smallest number of half precision.
constexpr int beside_activated = 8;
constexpr float share_activated = 1.f / 64;
void launch_activate(long count, int channels, const void* x, const float* shift, void* out,
                     cudaStream_t stream);

}  // namespace wetcurl
