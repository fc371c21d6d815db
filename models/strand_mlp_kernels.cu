// What stands between a StrandMlp's matrix products.
// Ours.
#include <cuda_fp16.h>

#include "base/device_buffer.h"
#include "models/strand_mlp_kernels.h"

namespace wetcurl {

namespace {

constexpr int tile = 32, tile_rows = 8;  // pixels and channels, turned over in shared memory

__global__ void normalise_kernel(int area, int inputs, int channels, const float* __restrict__ image,
                                 const float* __restrict__ mean, const float* __restrict__ deviation,
                                 float most, __half* __restrict__ rows, __half* __restrict__ mask) {
    __shared__ float turned[tile][tile + 1];
    __shared__ bool part[tile_rows][tile];
    const int first = int(blockIdx.x) * tile, lane = int(threadIdx.x);
    const size_t from = size_t(blockIdx.y) * inputs * area, to = size_t(blockIdx.y) * area;
    bool any = false;
    for (int c0 = 0; c0 < channels; c0 += tile) {
        __syncthreads();
        for (int k = int(threadIdx.y); k < tile; k += tile_rows) {
            const int c = c0 + k, p = first + lane;
            float x = 0;
            if (c < inputs && p < area) {
                x = image[from + size_t(c) * area + p];
                any |= x != 0;
                x = (x - mean[c]) / deviation[c];
            }
            turned[k][lane] = fminf(fmaxf(x, -most), most);
        }
        __syncthreads();
        for (int k = int(threadIdx.y); k < tile; k += tile_rows) {
            const int c = c0 + lane, p = first + k;
            if (c < channels && p < area) rows[(to + p) * channels + c] = __float2half_rn(turned[lane][k]);
        }
    }
    if (!mask) return;
    part[threadIdx.y][lane] = any;
    __syncthreads();
    if (threadIdx.y > 0 || first + lane >= area) return;
    for (int k = 1; k < tile_rows; ++k) any |= part[k][lane];
    mask[to + first + lane] = __float2half_rn(any ? 1.f : 0.f);
}

__global__ void activate_kernel(size_t pairs, int channels, const __half2* __restrict__ x,
                                const float* __restrict__ shift, float2* __restrict__ out) {
    const size_t k = size_t(blockIdx.x) * blockDim.x + threadIdx.x;
    if (k >= pairs) return;
    const int c = int(2 * k % size_t(channels));
    const float2 y = __half22float2(x[k]);
    out[k] = {fmaxf(y.x + shift[c], 0), fmaxf(y.y + shift[c + 1], 0)};
}

constexpr int kernel = 5, reach = kernel / 2, pairs = 32, rows = 8, strip = 8;

// A warp takes 64 channels, two a lane, of a strip of 8 pixels; 8 warps the strips one below the other, which
// read the same lines.
template <bool masked>
__global__ void mix_kernel(GridOfRows grid, const __half2* __restrict__ x, const __half* __restrict__ mask,
                           const __half* __restrict__ taps, const float* __restrict__ shift,
                           __half2* __restrict__ out) {
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
    const float2 more{shift[2 * pair], shift[2 * pair + 1]};
    float2 sum[strip] = {};
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
            const float2 x_here = __half22float2(read[k]);
            seen[k] = {x_here.x + more.x, x_here.y + more.y};
            // The pixel itself counts whatever its mask.
            if (dy == 0 && k >= reach && k < strip + reach)
                sum[k - reach].x += seen[k].x, sum[k - reach].y += seen[k].y;
            if (!row || column < 0 || column >= grid.width) seen[k] = {0, 0};
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
        if (left + k < grid.width) out[(line + k) * half + pair] = __floats2half2_rn(sum[k].x, sum[k].y);
}

}  // namespace

static unsigned blocks(size_t count, int size) { return unsigned((count + size - 1) / size); }

void launch_normalise(const GridOfRows& grid, int inputs, const float* image, const float* mean,
                      const float* deviation, float most, void* rows, void* mask, cudaStream_t stream) {
    const int area = grid.height * grid.width;
    normalise_kernel<<<dim3(blocks(area, tile), unsigned(grid.images)), dim3(tile, tile_rows), 0, stream>>>(
        area, inputs, grid.channels, image, mean, deviation, most, static_cast<__half*>(rows),
        static_cast<__half*>(mask));
    check_cuda(cudaGetLastError(), "inputs of a strand network");
}

void launch_activate(long count, int channels, const void* x, const float* shift, float* out,
                     cudaStream_t stream) {
    constexpr int threads = 256;
    const size_t pairs = size_t(count) * size_t(channels) / 2;
    activate_kernel<<<blocks(pairs, threads), threads, 0, stream>>>(
        pairs, channels, static_cast<const __half2*>(x), shift, reinterpret_cast<float2*>(out));
    check_cuda(cudaGetLastError(), "outputs of a strand network's body");
}

void launch_mix(const GridOfRows& grid, const void* x, const void* mask, const void* taps, const float* shift,
                void* out, cudaStream_t stream) {
    const dim3 grid_of_blocks(blocks(grid.width, strip), blocks(grid.height, rows),
                              unsigned(grid.images) * blocks(grid.channels / 2, pairs));
    const auto launch = [&](auto* kernel) {
        kernel<<<grid_of_blocks, dim3(pairs, rows), 0, stream>>>(
            grid, static_cast<const __half2*>(x), static_cast<const __half*>(mask),
            static_cast<const __half*>(taps), shift, static_cast<__half2*>(out));
    };
    mask ? launch(mix_kernel<true>) : launch(mix_kernel<false>);
    check_cuda(cudaGetLastError(), "look at the pixels around");
}

}  // namespace wetcurl
