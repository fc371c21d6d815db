// What stands between a StrandMlp's matrix products.
#include <cuda_fp16.h>
#include <cuda_pipeline.h>

#include "base/device_buffer.h"
#include "models/strand_mlp_kernels.h"

namespace wetcurl {

namespace {

constexpr int warp = 32;
// Channels that a block takes at a time, a pixel a lane: all of them are asked for before one is there.
constexpr int chunk = 256, chunk_rows = 8, each = chunk / chunk_rows;

__global__ void __launch_bounds__(warp* chunk_rows)
    normalise_kernel(int area, int inputs, int channels, const float* __restrict__ image,
                     const float* __restrict__ mean, const float* __restrict__ share, float most,
                     __half2* __restrict__ rows, __half* __restrict__ mask) {
    __shared__ __align__(4) __half turned[warp][chunk + 2];  // pixels lie in different banks
    __shared__ bool part[chunk_rows][warp];
    const int lane = int(threadIdx.x), row = int(threadIdx.y), first = int(blockIdx.x) * warp,
              p = first + lane;
    const size_t from = size_t(blockIdx.y) * inputs * area, to = size_t(blockIdx.y) * area;
    bool any = false;
    for (int c0 = 0; c0 < channels; c0 += chunk) {
        float x[each];
#pragma unroll
        for (int k = 0; k < each; ++k) {
            const int c = c0 + k * chunk_rows + row;
            x[k] = c < inputs && p < area ? image[from + size_t(c) * area + p] : 0;
        }
        __syncthreads();
#pragma unroll
        for (int k = 0; k < each; ++k) {
            const int at = k * chunk_rows + row, c = c0 + at;
            any |= x[k] != 0;
            if (c < inputs) x[k] = (x[k] - mean[c]) * share[c];
            turned[lane][at] = __float2half_rn(fminf(fmaxf(x[k], -most), most));
        }
        __syncthreads();
        for (int k = row; k < warp && first + k < area; k += chunk_rows)
            for (int pair = lane; pair < chunk / 2 && c0 + 2 * pair < channels; pair += warp)
                rows[(to + first + k) * (channels / 2) + c0 / 2 + pair] =
                    *reinterpret_cast<const __half2*>(&turned[k][2 * pair]);
    }
    if (!mask) return;
    part[row][lane] = any;
    __syncthreads();
    if (row > 0 || p >= area) return;
    for (int k = 1; k < chunk_rows; ++k) any |= part[k][lane];
    mask[to + p] = __float2half_rn(any ? 1.f : 0.f);
}

constexpr int oct = 8;  // channels of a thread
static_assert(beside_activated == oct);

struct alignas(16) Oct {
    __half2 of[oct / 2];
};

__global__ void activate_kernel(unsigned count, unsigned octs, const Oct* __restrict__ x,
                                const float2* __restrict__ shift, Oct* __restrict__ out) {
    const unsigned k = blockIdx.x * blockDim.x + threadIdx.x, row = k / (octs + 1), o = k % (octs + 1);
    if (row >= count) return;
    Oct y{};
    if (o == octs) {
        y.of[0] = __floats2half2_rn(1, 1);
    } else {
        y = x[row * octs + o];
#pragma unroll
        for (int i = 0; i < oct / 2; ++i) {
            const float2 from = __half22float2(y.of[i]), by = shift[o * (oct / 2) + i];
            y.of[i] = __floats2half2_rn(share_activated * fmaxf(from.x + by.x, 0),
                                        share_activated * fmaxf(from.y + by.y, 0));
        }
    }
    out[k] = y;
}

constexpr int kernel = 5, reach = kernel / 2, taps = kernel * kernel;
// A lane takes two channels, a warp 64 of them, of a strip of pixels, so wide and high; a block these strips
// side by side and one below the other. What they read, with all around it, it holds.
constexpr int strip = 8, high = 2, across = 2, down = 4, warps = across * down;
constexpr int tile_width = across * strip, tile_height = down * high, held_width = tile_width + 2 * reach,
              held_pixels = held_width * (tile_height + 2 * reach);
constexpr int quad = 4, quads = warp / quad;  // pairs of channels that are fetched at once

// What is summed up in half precision before it goes on in single precision: rows of the kernel 0 to 2, 3
// and 4.
constexpr int parts = 2, first_part = 3;

template <bool masked>
__global__ void __launch_bounds__(warp* warps, 3)
    mix_kernel(GridOfRows grid, const __half2* __restrict__ x, const __half* __restrict__ mask,
               const __half2* __restrict__ tap_of, const float2* __restrict__ shift,
               const float2* __restrict__ lift, __half2* __restrict__ out) {
    __shared__ __align__(16) __half2 held[held_pixels][warp];
    const int half = grid.channels / 2, slices = (half + warp - 1) / warp, lane = int(threadIdx.x),
              first = int(blockIdx.z) % slices * warp, pair = first + lane;
    const bool mine = pair < half;
    const int left = int(blockIdx.x) * tile_width - reach, top = int(blockIdx.y) * tile_height - reach;
    const size_t image = size_t(int(blockIdx.z) / slices) * grid.height * grid.width;
    const bool within = left >= 0 && top >= 0 && left + held_width <= grid.width &&
                        top + held_pixels / held_width <= grid.height;
    // Of a held pixel; below 0 outside the image.
    auto pixel_of = [&](int k) -> long {
        const int row = top + k / held_width, column = left + k % held_width;
        if (row < 0 || row >= grid.height || column < 0 || column >= grid.width) return -1;
        return long(image) + long(row) * grid.width + column;
    };
    // As it comes.
    for (int k = (int(threadIdx.y) * warp + lane) / quads; k < held_pixels; k += warps * warp / quads) {
        const int at = lane % quads * quad;
        const long pixel = pixel_of(k);
        const bool there = pixel >= 0 && first + at < half;
        __pipeline_memcpy_async(&held[k][at], x + (there ? size_t(pixel) * half + first + at : 0),
                                sizeof(__half2) * quad, there ? 0 : sizeof(__half2) * quad);
    }
    __pipeline_commit();
    __half2 tap[taps];
#pragma unroll
    for (int t = 0; t < taps; ++t) tap[t] = mine ? tap_of[t * half + pair] : __half2{};
    __pipeline_wait_prior(0);
    __syncthreads();
    const int column = int(threadIdx.y) % across * strip, row = int(threadIdx.y) / across * high;
    auto held_at = [&](int r, int c) -> __half2& { return held[(row + r) * held_width + column + c][lane]; };
    // Where all that is seen is there alike, a shift of it all comes to the same everywhere.
    float2 more = mine ? lift[pair] : float2{0, 0};
    __half2 own[high][strip];
#pragma unroll
    for (int h = 0; h < high; ++h)
#pragma unroll
        for (int k = 0; k < strip; ++k) own[h][k] = held_at(h + reach, k + reach);
    if (masked || !within) {
        more = mine ? shift[pair] : float2{0, 0};
        __syncthreads();
        for (int k = int(threadIdx.y); k < held_pixels; k += warps) {
            const long pixel = pixel_of(k);
            if (pixel < 0) continue;
            const float share = masked ? __half2float(mask[pixel]) : 1;
            const float2 y = __half22float2(held[k][lane]);
            held[k][lane] = __floats2half2_rn(share * (y.x + more.x), share * (y.y + more.y));
        }
        __syncthreads();
    }
    __half2 sum[parts][high][strip];
#pragma unroll
    for (int r = 0; r < high + 2 * reach; ++r) {
        __half2 line[strip + 2 * reach];
#pragma unroll
        for (int k = 0; k < strip + 2 * reach; ++k) line[k] = held_at(r, k);
#pragma unroll
        for (int h = 0; h < high; ++h) {
            const int dy = r - h;
            if (dy < 0 || dy >= kernel) continue;
            const int part = dy < first_part ? 0 : 1;
#pragma unroll
            for (int k = 0; k < strip; ++k) {
                __half2& to = sum[part][h][k];
                const __half2* w = tap + dy * kernel;
                to = dy == 0 || dy == first_part ? __hmul2(w[0], line[k]) : __hfma2(w[0], line[k], to);
#pragma unroll
                for (int dx = 1; dx < kernel; ++dx) to = __hfma2(w[dx], line[k + dx], to);
            }
        }
    }
#pragma unroll
    for (int h = 0; h < high; ++h)
#pragma unroll
        for (int k = 0; k < strip; ++k) {
            const int y = top + reach + row + h, c = left + reach + column + k;
            if (!mine || y >= grid.height || c >= grid.width) continue;
            // The pixel itself counts whatever its mask.
            const float2 a = __half22float2(own[h][k]), b = __half22float2(sum[0][h][k]),
                         d = __half22float2(sum[1][h][k]);
            out[(image + size_t(y) * grid.width + c) * half + pair] =
                __floats2half2_rn(a.x + more.x + b.x + d.x, a.y + more.y + b.y + d.y);
        }
}

}  // namespace

static unsigned blocks(size_t count, int size) { return unsigned((count + size - 1) / size); }

void launch_normalise(const GridOfRows& grid, int inputs, const float* image, const float* mean,
                      const float* share, float most, void* rows, void* mask, cudaStream_t stream) {
    const int area = grid.height * grid.width;
    normalise_kernel<<<dim3(blocks(area, warp), unsigned(grid.images)), dim3(warp, chunk_rows), 0, stream>>>(
        area, inputs, grid.channels, image, mean, share, most, static_cast<__half2*>(rows),
        static_cast<__half*>(mask));
    check_cuda(cudaGetLastError(), "inputs of a strand network");
}

void launch_activate(long count, int channels, const void* x, const float* shift, void* out,
                     cudaStream_t stream) {
    constexpr int threads = 256;
    const unsigned octs = unsigned(channels / oct);
    activate_kernel<<<blocks(size_t(count) * (octs + 1), threads), threads, 0, stream>>>(
        unsigned(count), octs, static_cast<const Oct*>(x), reinterpret_cast<const float2*>(shift),
        static_cast<Oct*>(out));
    check_cuda(cudaGetLastError(), "outputs of a strand network's body");
}

void launch_mix(const GridOfRows& grid, const void* x, const void* mask, const void* taps, const float* shift,
                const float* lift, void* out, cudaStream_t stream) {
    const dim3 grid_of_blocks(blocks(grid.width, tile_width), blocks(grid.height, tile_height),
                              unsigned(grid.images) * blocks(grid.channels / 2, warp));
    const auto launch = [&](auto* kernel) {
        kernel<<<grid_of_blocks, dim3(warp, warps), 0, stream>>>(
            grid, static_cast<const __half2*>(x), static_cast<const __half*>(mask),
            static_cast<const __half2*>(taps), reinterpret_cast<const float2*>(shift),
            reinterpret_cast<const float2*>(lift), static_cast<__half2*>(out));
    };
    mask ? launch(mix_kernel<true>) : launch(mix_kernel<false>);
    check_cuda(cudaGetLastError(), "look at the pixels around");
}

}  // namespace wetcurl
