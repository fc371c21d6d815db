// The look at the pixels around on a CUDA device.
// Ours.
#include <cuda_fp16.h>

#include "base/device_buffer.h"
#include "models/mix_kernel.h"

namespace wetcurl {

namespace {

constexpr int kernel = 5, reach = kernel / 2, pairs = 32, rows = 8, strip = 8;

// A warp takes 64 channels, two a lane, of a strip of 8 pixels; 8 warps the strips one below the other, which
// read the same lines.
template <bool masked>
__global__ void mix_kernel(GridOfRows grid, const __half2* __restrict__ x, const __half* __restrict__ mask,
                           const __half* __restrict__ taps, __half2* __restrict__ out) {
    __shared__ float2 tap[kernel * kernel][pairs];
    const int half = grid.channels / 2, first = int(blockIdx.z) % ((half + pairs - 1) / pairs) * pairs,
              image = int(blockIdx.z) / ((half + pairs - 1) / pairs);
    const int lane = int(threadIdx.x), pair = first + lane;
    for (int k = int(threadIdx.y) * pairs + lane; k < kernel * kernel * pairs; k += rows * pairs) {
        const int p = k / (kernel * kernel), t = k % (kernel * kernel);
        if (first + p >= half) continue;
        const __half* from = taps + size_t(2 * (first + p)) * kernel * kernel + t;
        tap[t][p] = {__half2float(from[0]), __half2float(from[kernel * kernel])};
    }
    __syncthreads();
    const int y = int(blockIdx.y) * rows + int(threadIdx.y), left = int(blockIdx.x) * strip;
    if (pair >= half || y >= grid.height) return;
    float2 sum[strip] = {};
    __half2 here[strip] = {};
    const __half2 none = __floats2half2_rn(0, 0);
#pragma unroll
    for (int dy = -reach; dy <= reach; ++dy) {
        // Beyond the border the nearest pixel is read and then left out: loads without branches go out
        // together.
        const bool row = y + dy >= 0 && y + dy < grid.height;
        const size_t line = (size_t(image) * grid.height + (row ? y + dy : y)) * grid.width;
        __half2 read[strip + 2 * reach];
        float share[strip + 2 * reach];
#pragma unroll
        for (int k = 0; k < strip + 2 * reach; ++k) {
            const int column = min(max(left + k - reach, 0), grid.width - 1);
            read[k] = x[(line + column) * half + pair];
            if (masked) share[k] = __half2float(mask[line + column]);
        }
        float2 seen[strip + 2 * reach];
#pragma unroll
        for (int k = 0; k < strip + 2 * reach; ++k) {
            const int column = left + k - reach;
            if (dy == 0 && k >= reach && k < strip + reach) here[k - reach] = read[k];
            const __half2 v = row && column >= 0 && column < grid.width ? read[k] : none;
            seen[k] = __half22float2(v);
            if (masked) seen[k].x *= share[k], seen[k].y *= share[k];
        }
#pragma unroll
        for (int dx = 0; dx < kernel; ++dx) {
            const float2 w = tap[(dy + reach) * kernel + dx][lane];
#pragma unroll
            for (int k = 0; k < strip; ++k)
                sum[k].x += w.x * seen[k + dx].x, sum[k].y += w.y * seen[k + dx].y;
        }
    }
    const size_t line = (size_t(image) * grid.height + y) * grid.width + left;
#pragma unroll
    for (int k = 0; k < strip; ++k)
        if (left + k < grid.width)
            out[(line + k) * half + pair] =
                __floats2half2_rn(__low2float(here[k]) + sum[k].x, __high2float(here[k]) + sum[k].y);
}

}  // namespace

void launch_mix(const GridOfRows& grid, const void* x, const void* mask, const void* taps, void* out,
                cudaStream_t stream) {
    const auto blocks = [](int count, int size) { return unsigned((count + size - 1) / size); };
    const dim3 grid_of_blocks(blocks(grid.width, strip), blocks(grid.height, rows),
                              unsigned(grid.images) * blocks(grid.channels / 2, pairs));
    const auto launch = [&](auto* kernel) {
        kernel<<<grid_of_blocks, dim3(pairs, rows), 0, stream>>>(
            grid, static_cast<const __half2*>(x), static_cast<const __half*>(mask),
            static_cast<const __half*>(taps), static_cast<__half2*>(out));
    };
    mask ? launch(mix_kernel<true>) : launch(mix_kernel<false>);
    check_cuda(cudaGetLastError(), "look at the pixels around");
}

}  // namespace wetcurl
