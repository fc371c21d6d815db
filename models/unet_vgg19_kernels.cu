// What UnetVgg19 does on a device beside LibTorch's large convolutions.
// Ours.
#include <cuda_fp16.h>
#include <cuda_pipeline.h>

#include <algorithm>

#include "base/device_buffer.h"
#include "models/unet_vgg19_kernels.h"

namespace wetcurl {

namespace {

constexpr int taps = 5, reach = taps / 2;
constexpr int eight = 8;  // channels, read and written at once

struct alignas(16) Eight {
    __half2 of[4];
};

unsigned blocks_of(size_t jobs, int threads) {
    return unsigned((jobs + size_t(threads) - 1) / size_t(threads));
}

// Where channels c .. c + 7 of a pixel lie.
__device__ const Eight* eight_of(const JoinedImage& x, int image, int row, int column, int c) {
    const __half* from;
    if (c < x.doubled_channels) {
        const size_t pixel = (size_t(image) * (x.height / 2) + row / 2) * (x.width / 2) + column / 2;
        from = static_cast<const __half*>(x.doubled) +
               (4 * pixel + 2 * (row % 2) + column % 2) * x.doubled_channels + c;
    } else {
        const size_t pixel = (size_t(image) * x.height + row) * x.width + column;
        from = static_cast<const __half*>(x.skip) + pixel * x.skip_channels + (c - x.doubled_channels);
    }
    return reinterpret_cast<const Eight*>(from);
}

constexpr int threads_a_block = 256, warps = threads_a_block / 32;

__global__ void join_kernel(const JoinedImage x, int groups, size_t jobs, Eight* out) {
    const size_t k = size_t(blockIdx.x) * threads_a_block + threadIdx.x;
    if (k >= jobs) return;
    const size_t pixel = k / groups, row = pixel / x.width;
    out[k] =
        *eight_of(x, int(row / x.height), int(row % x.height), int(pixel % x.width), int(k % groups) * eight);
}

// groups: of eight channels; width: of what comes out.
__global__ void pool_kernel(int width, int groups, size_t jobs, const Eight* x, Eight* out) {
    const size_t k = size_t(blockIdx.x) * threads_a_block + threadIdx.x;
    if (k >= jobs) return;
    const size_t pixel = k / groups, row = pixel / width, wide = 2 * size_t(width) * groups,
                 from = 2 * row * wide + 2 * (pixel % width) * groups + k % groups;
    const Eight a = x[from], b = x[from + groups], c = x[from + wide], d = x[from + wide + groups];
    Eight most;
    for (int l = 0; l < 4; ++l)
        most.of[l] = __hmax2_nan(__hmax2_nan(a.of[l], b.of[l]), __hmax2_nan(c.of[l], d.of[l]));
    out[k] = most;
}

__host__ __device__ constexpr int parts_of(int whole, int part) { return (whole + part - 1) / part; }

// A tile of an image, `across` x `down` pixels, and the pixels around it, as a block of threads holds them; 0
// beyond the image.
template <int across, int down>
struct Tile {
    static constexpr int wide = across + 2 * reach, high = down + 2 * reach, line = 64;
    // Numbers from a pixel to the next: two of them lie in different banks, 64 numbers wide.
    static __host__ __device__ int stride(int channels) {
        return (channels + line / 2 - 1) / line * line + line / 2;
    }
    static size_t bytes(int channels) {
        return size_t(wide * high) * size_t(stride(channels)) * sizeof(__half);
    }
    static __device__ void load(__half* own, const JoinedImage& x, int image, int top, int left) {
        const int channels = x.channels(), groups = channels / eight;
        for (int k = int(threadIdx.x); k < wide * high * groups; k += int(blockDim.x)) {
            const int pixel = k / groups, c = k % groups * eight, row = top - reach + pixel / wide,
                      column = left - reach + pixel % wide;
            const bool there = row >= 0 && row < x.height && column >= 0 && column < x.width;
            __pipeline_memcpy_async(own + pixel * stride(channels) + c,
                                    eight_of(x, image, there ? row : 0, there ? column : 0, c), sizeof(Eight),
                                    there ? 0 : sizeof(Eight));
        }
        __pipeline_commit();
        __pipeline_wait_prior(0);
    }
};

// Tiles of 8 pixels a row. A warp's product: rows of 16 pixels, two rows of a tile, by 8 outputs, over 16
// channels; lanes take rows and channels as PTX says of mma.m16n8k16, but which of them are which is ours, as
// it adds them up alike: a lane has eight channels side by side, and two products take them.
constexpr int across = 8, of_product = 2, outputs_of_product = 8, deep = 32;

__device__ void add_product(float (&sum)[4], uint32_t a0, uint32_t a1, uint32_t a2, uint32_t a3, uint32_t b0,
                            uint32_t b1) {
    asm("mma.sync.aligned.m16n8k16.row.col.f32.f16.f16.f32 {%0, %1, %2, %3}, {%4, %5, %6, %7}, {%8, %9}, "
        "{%0, %1, %2, %3};"
        : "+f"(sum[0]), "+f"(sum[1]), "+f"(sum[2]), "+f"(sum[3])
        : "r"(a0), "r"(a1), "r"(a2), "r"(a3), "r"(b0), "r"(b1));
}

// The 5x5 sums of a block's tile, `rows` times 16 pixels, for `columns` times 8 outputs from `first` on:
// warps share out taps and channels, and ask for their weights before they need them. They leave (warp,
// pixel, output) in shared memory, of so many bytes, where the tile was before.
template <int rows, int columns>
struct TileSums {
    static constexpr int down = of_product * rows, pixels = across * down,
                         outputs = outputs_of_product * columns, ahead = columns > 2 ? 1 : 4 / columns;
    using Held = Tile<across, down>;

    static size_t bytes(int channels) {
        return std::max(Held::bytes(channels), size_t(warps) * pixels * outputs * sizeof(float));
    }
    static unsigned tiles(const JoinedImage& x) {
        return unsigned(x.images) * unsigned(parts_of(x.height, down) * parts_of(x.width, across));
    }

    int image, top, left;  // of the tile

    __device__ TileSums(const JoinedImage& x, const __half* weight, int first, unsigned char* own) {
        const int tiles_across = parts_of(x.width, across), tiles_down = parts_of(x.height, down),
                  tile = int(blockIdx.x), mine = int(threadIdx.x) / 32, lane = int(threadIdx.x) % 32,
                  group = lane / 4, member = lane % 4, channels = x.channels(), parts = channels / deep,
                  chunks = taps * taps * parts, stride = Held::stride(channels);
        image = tile / (tiles_across * tiles_down), top = tile / tiles_across % tiles_down * down,
        left = tile % tiles_across * across;
        const uint4* const weights = reinterpret_cast<const uint4*>(
            weight + size_t(first + group) * (taps * taps * channels) + eight * member);
        __half* const held = reinterpret_cast<__half*>(own);
        const size_t to_next = size_t(outputs_of_product) * (taps * taps * channels) / eight;
        // Two lots of them, in turn.
        using Weights = uint4[ahead][columns];
        Weights one, other;
        auto fetch = [&](int chunk, Weights& to) {
#pragma unroll
            for (int a = 0; a < ahead; ++a)
#pragma unroll
                for (int c = 0; c < columns; ++c)
                    to[a][c] =
                        __ldg(weights + c * to_next + min(chunk + a * warps, chunks - 1) * (deep / eight));
        };
        float sum[rows][columns][4] = {};
        auto add = [&](int chunk, const Weights& b) {
#pragma unroll
            for (int a = 0; a < ahead; ++a) {
                const int at = chunk + a * warps, tap = at / parts;
                if (at >= chunks) return;
                const __half* from = held + (tap / taps * Held::wide + tap % taps + group) * stride +
                                     at % parts * deep + eight * member;
#pragma unroll
                for (int r = 0; r < rows; ++r) {
                    const __half* const of_row = from + 2 * r * Held::wide * stride;
                    const uint4 p = *reinterpret_cast<const uint4*>(of_row),
                                q = *reinterpret_cast<const uint4*>(of_row + Held::wide * stride);
                    // No product waits for the one before it.
#pragma unroll
                    for (int c = 0; c < columns; ++c)
                        add_product(sum[r][c], p.x, q.x, p.y, q.y, b[a][c].x, b[a][c].y);
#pragma unroll
                    for (int c = 0; c < columns; ++c)
                        add_product(sum[r][c], p.z, q.z, p.w, q.w, b[a][c].z, b[a][c].w);
                }
            }
        };
        constexpr int lot = ahead * warps;
        fetch(mine, one), fetch(mine + lot, other);
        Held::load(held, x, image, top, left);
        __syncthreads();
        for (int chunk = mine; chunk < chunks; chunk += 2 * lot) {
            add(chunk, one), fetch(chunk + 2 * lot, one);
            add(chunk + lot, other), fetch(chunk + 3 * lot, other);
        }
        __syncthreads();
        float2* const sums = reinterpret_cast<float2*>(own);
        constexpr int pairs = outputs / 2;
#pragma unroll
        for (int r = 0; r < rows; ++r)
#pragma unroll
            for (int c = 0; c < columns; ++c) {
                float2* const to = sums + (mine * pixels + 2 * r * across + group) * pairs + c * 4 + member;
                to[0] = {sum[r][c][0], sum[r][c][1]}, to[across * pairs] = {sum[r][c][2], sum[r][c][3]};
            }
        __syncthreads();
    }
};

// ReLU, which NaN gets through.
__device__ float rectified(float x) { return x < 0 ? 0 : x; }

template <int rows, int columns>
__global__ void __launch_bounds__(threads_a_block, 2)
    convolve_kernel(const JoinedImage x, const __half* __restrict__ weight, const __half* __restrict__ bias,
                    int outputs, __half* out) {
    using Sums = TileSums<rows, columns>;
    constexpr int pairs = Sums::outputs / 2, each = Sums::pixels * pairs;
    extern __shared__ __align__(32) unsigned char own[];
    const int first = int(blockIdx.y) * Sums::outputs;
    const Sums tile(x, weight, first, own);
    const float2* const sums = reinterpret_cast<const float2*>(own);
    for (int k = int(threadIdx.x); k < each; k += threads_a_block) {
        const int row = tile.top + k / pairs / across, column = tile.left + k / pairs % across,
                  c = first + 2 * (k % pairs);
        if (row >= x.height || column >= x.width) continue;
        float2 all = __half22float2(*reinterpret_cast<const __half2*>(bias + c));
        for (int w = 0; w < warps; ++w) all.x += sums[w * each + k].x, all.y += sums[w * each + k].y;
        const size_t pixel = (size_t(tile.image) * x.height + row) * x.width + column;
        *reinterpret_cast<__half2*>(out + pixel * outputs + c) =
            __floats2half2_rn(rectified(all.x), rectified(all.y));
    }
}

// up() of a plane (height, width) at a row and a column of twice as many: models/layers.h.
__device__ float doubled_at(const float* plane, int height, int width, int row, int column) {
    auto along = [](int n, int k, auto at) {
        if (k % 2 == 0) return at(k / 2);
        const float here = at(k / 2), next = k / 2 + 1 < n ? at(k / 2 + 1)
                                             : n > 1       ? 2 * here - at(n - 2)
                                                           : here;
        return 0.5f * (here + next);
    };
    return along(width, column, [&](int c) {
        return along(height, row, [&](int r) { return plane[size_t(r) * width + c]; });
    });
}

using LastTile = TileSums<4, 1>;

__global__ void __launch_bounds__(threads_a_block, 2)
    last_kernel(const JoinedImage x, const __half* __restrict__ weight, const float* __restrict__ bias,
                int outputs, const float* base, int height, int width, float* out) {
    extern __shared__ __align__(32) unsigned char own[];
    const LastTile tile(x, weight, 0, own);
    const float* const sums = reinterpret_cast<const float*>(own);
    for (int k = int(threadIdx.x); k < LastTile::pixels * outputs; k += threads_a_block) {
        const int c = k / LastTile::pixels, pixel = k % LastTile::pixels, row = tile.top + pixel / across,
                  column = tile.left + pixel % across;
        if (row >= height || column >= width) continue;
        float sum = bias[c];
        for (int w = 0; w < warps; ++w) sum += sums[(w * LastTile::pixels + pixel) * LastTile::outputs + c];
        const size_t plane = size_t(tile.image) * outputs + c;
        if (base)
            sum += doubled_at(base + plane * (height / 2) * (width / 2), height / 2, width / 2, row, column);
        out[(plane * height + row) * width + column] = sum;
    }
}

}  // namespace

void launch_join(const JoinedImage& x, void* out, cudaStream_t stream) {
    const int groups = x.channels() / eight;
    const size_t jobs = size_t(x.images) * x.height * x.width * groups;
    join_kernel<<<blocks_of(jobs, threads_a_block), threads_a_block, 0, stream>>>(x, groups, jobs,
                                                                                  static_cast<Eight*>(out));
    check_cuda(cudaGetLastError(), "launch of what joins images");
}

void launch_pool(int images, int height, int width, int channels, const void* x, void* out,
                 cudaStream_t stream) {
    const int groups = channels / eight;
    const size_t jobs = size_t(images) * (height / 2) * (width / 2) * groups;
    pool_kernel<<<blocks_of(jobs, threads_a_block), threads_a_block, 0, stream>>>(
        width / 2, groups, jobs, static_cast<const Eight*>(x), static_cast<Eight*>(out));
    check_cuda(cudaGetLastError(), "launch of a pool");
}

bool launch_convolution(const JoinedImage& x, const void* weight, const void* bias, int outputs, void* out,
                        cudaStream_t stream) {
    // Seen on an H100: LibTorch's are faster for more outputs or pixels.
    constexpr int most_outputs = 64, busy = 96;  // blocks
    constexpr unsigned most_tiles = 64;          // of 64 pixels
    const unsigned tiles = TileSums<4, 4>::tiles(x), groups = unsigned(outputs / outputs_of_product);
    if (x.channels() % deep != 0 || outputs % 32 != 0 || outputs > most_outputs || tiles > most_tiles)
        return false;
    auto launch = [&]<int rows, int columns>() {
        using Sums = TileSums<rows, columns>;
        const auto kernel = convolve_kernel<rows, columns>;
        const size_t bytes = Sums::bytes(x.channels());
        if (bytes > allow_shared_memory(kernel)) return false;
        const dim3 blocks(Sums::tiles(x), unsigned(outputs / Sums::outputs));
        kernel<<<blocks, threads_a_block, bytes, stream>>>(x, static_cast<const __half*>(weight),
                                                           static_cast<const __half*>(bias), outputs,
                                                           static_cast<__half*>(out));
        check_cuda(cudaGetLastError(), "launch of a convolution");
        return true;
    };
    // As large a part of it a block as leaves no processor idle.
    if (tiles * groups / 4 >= busy) return launch.operator()<4, 4>();
    if (tiles * groups >= busy) return launch.operator()<2, 2>();
    return launch.operator()<2, 1>();
}

bool can_launch_last(int channels) {
    return channels % deep == 0 && LastTile::bytes(channels) <= allow_shared_memory(last_kernel);
}

void launch_last(int images, int H, int W, int C, const void* x, const void* weight, const float* bias,
                 int outputs, const float* base, int height, int width, float* out, cudaStream_t stream) {
    const JoinedImage image{images, H, W, nullptr, x, 0, C};
    const size_t bytes = LastTile::bytes(C);
    allow_shared_memory(last_kernel);
    last_kernel<<<LastTile::tiles(image), threads_a_block, bytes, stream>>>(
        image, static_cast<const __half*>(weight), bias, outputs, base, height, width, out);
    check_cuda(cudaGetLastError(), "launch of the last convolution");
}

}  // namespace wetcurl
