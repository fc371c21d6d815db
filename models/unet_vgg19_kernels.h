// UnetVgg19 in half precision on a device of compute capability 9.0 (H100, H200): LibTorch's convolutions
// take longer on the few pixels of a patch. The reference is models/unet_vgg19.cpp.
#pragma once

#include <cuda_runtime.h>

#include <cstddef>

#include "base/host_device.h"

namespace wetcurl {

// An image in half precision, (B, H, W, channels): `doubled`, a pixel's four as its doubling gives them, (B,
// H / 2, W / 2, 2, 2, doubled_channels), then `skip` (B, H, W, skip_channels). Both multiples of 16; either
// may be 0.
struct JoinedImage {
    int images, height, width;
    const void* doubled;
    const void* skip;
    int doubled_channels, skip_channels;
    WETCURL_HD int channels() const { return doubled_channels + skip_channels; }
    // Where channels c .. c + 7 of a pixel lie.
    WETCURL_HD const void* eight_at(int image, int row, int column, int c) const {
        constexpr size_t bytes = 2;  // of a number
        if (c >= doubled_channels) {
            const size_t pixel = (size_t(image) * height + row) * width + column;
            return static_cast<const char*>(skip) + (pixel * skip_channels + (c - doubled_channels)) * bytes;
        }
        const size_t pixel = (size_t(image) * (height / 2) + row / 2) * (width / 2) + column / 2;
        return static_cast<const char*>(doubled) +
               ((4 * pixel + 2 * (row % 2) + column % 2) * doubled_channels + c) * bytes;
    }
};

// Channels come by 16 and outputs by so many, filled up with 0; the last layer has few, each with 25 taps,
// and these are filled up to `last_columns`.
inline constexpr int channels_at_once = 16, outputs_at_once = 64, most_last_outputs = 3, last_columns = 80;

// Whether the current device can launch these for images of so many channels.
bool can_convolve(int channels);
bool can_launch_last(int channels);

// All on the current device; sums in single precision, rounded once. Throw Error where the launch fails.

// x (B, C, H, W) in single precision to out (B, H, W, channels), 0 beyond C.
void launch_take(int images, int height, int width, int C, int channels, const float* x, void* out,
                 cudaStream_t stream);

// out (B, H, W, outputs) = relu(5x5 convolution of x + bias): weight (outputs / 64, channels / 16, 5, 5, 2,
// 64, 8), bias (outputs), all in half precision. `pooled` (B, H / 2, W / 2, outputs), or null: the largest of
// each 2x2 of it, for even H and W.
void launch_convolution(const JoinedImage& x, const void* weight, const void* bias, int outputs, void* out,
                        void* pooled, cudaStream_t stream);

// out (B, outputs, height, width), single precision = 5x5 convolution of x + bias, of the upper left of x,
// where it can be; weight (last_columns, channels), (5, 5, outputs, channels) and 0 beyond, in half
// precision, bias (outputs) in single precision. `base` (B, outputs, height / 2, width / 2), or null: up() of
// it is added.
void launch_last(const JoinedImage& x, const void* weight, const float* bias, int outputs, const float* base,
                 int height, int width, float* out, cudaStream_t stream);

}  // namespace wetcurl
