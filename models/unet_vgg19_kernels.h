// UnetVgg19 on a CUDA device in half precision: what its convolutions on few pixels, its doublings and its
// last layer take too long for in LibTorch. The reference is models/unet_vgg19.cpp. Ours.
#pragma once

#include <cuda_runtime.h>

#include "base/host_device.h"

namespace wetcurl {

// An image in half precision, (B, H, W, channels): `doubled`, a pixel's four as its doubling gives them, (B,
// H / 2, W / 2, 2, 2, doubled_channels), then `skip` (B, H, W, skip_channels). Both multiples of 8; the
// former may be 0.
struct JoinedImage {
    int images, height, width;
    const void* doubled;
    const void* skip;
    int doubled_channels, skip_channels;
    WETCURL_HD int channels() const { return doubled_channels + skip_channels; }
};

// All on the current device; sums in single precision, rounded once. Throw Error where the launch fails.

// out (B, H, W, channels).
void launch_join(const JoinedImage& x, void* out, cudaStream_t stream);

// The largest of each 2x2: x (B, H, W, C) to out (B, H / 2, W / 2, C), C a multiple of 8, H and W even.
void launch_pool(int images, int height, int width, int channels, const void* x, void* out,
                 cudaStream_t stream);

// out (B, H, W, outputs) = relu(5x5 convolution of x + bias): weight (outputs, 5, 5, channels), bias
// (outputs), all in half precision. Returns false, and does nothing, where other convolutions are faster,
// where a processor has no room, and for channels and outputs that are no multiples of 32.
bool launch_convolution(const JoinedImage& x, const void* weight, const void* bias, int outputs, void* out,
                        cudaStream_t stream);

// out (B, outputs, height, width), single precision = 5x5 convolution of x + bias, of the upper left of x (B,
// H, W, C), where it can be; weight (8, 5, 5, C) in half precision, 0 beyond `outputs`, bias (outputs) in
// single precision. `base` (B, outputs, height / 2, width / 2), or null: up() of it is added.
bool can_launch_last(int channels);  // C, a multiple of 32 for which a processor has room
void launch_last(int images, int H, int W, int C, const void* x, const void* weight, const float* bias,
                 int outputs, const float* base, int height, int width, float* out, cudaStream_t stream);

}  // namespace wetcurl
