// What UnetVgg19 does on a device beside LibTorch's large convolutions.
// Ours.
#include <cuda_fp16.h>
#include <mma.h>

#include "base/device_buffer.h"
#include "models/unet_vgg19_kernels.h"

namespace wetcurl {

namespace {

using namespace nvcuda;

constexpr int taps = 5, reach = taps / 2;
constexpr int eight = 8;  // channels, read and written at once

struct alignas(16) Eight {
    __half2 of[4];
};

unsigned blocks_of(size_t jobs, int threads) {
    return unsigned((jobs + size_t(threads) - 1) / size_t(threads));
}

// Channels c .. c + 7 of a pixel.
__device__ Eight eight_of(const JoinedImage& x, int image, int row, int column, int c) {
    const __half* from;
    if (c < x.doubled_channels) {
        const size_t pixel = (size_t(image) * (x.height / 2) + row / 2) * (x.width / 2) + column / 2;
        from = static_cast<const __half*>(x.doubled) +
               (4 * pixel + 2 * (row % 2) + column % 2) * x.doubled_channels + c;
    } else {
        const size_t pixel = (size_t(image) * x.height + row) * x.width + column;
        from = static_cast<const __half*>(x.skip) + pixel * x.skip_channels + (c - x.doubled_channels);
    }
    return *reinterpret_cast<const Eight*>(from);
}

constexpr int threads_a_block = 256;

__global__ void join_kernel(const JoinedImage x, int groups, size_t jobs, Eight* out) {
    const size_t k = size_t(blockIdx.x) * threads_a_block + threadIdx.x;
    if (k >= jobs) return;
    const size_t pixel = k / groups, row = pixel / x.width;
    out[k] =
        eight_of(x, int(row / x.height), int(row % x.height), int(pixel % x.width), int(k % groups) * eight);
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

// A tile of an image, `across` x `down` pixels, and the pixels around it, as a block of threads holds them:
// so many channels of each, from `first` on, 0 beyond the image.
template <int across, int down>
struct Tile {
    static constexpr int wide = across + 2 * reach, high = down + 2 * reach, filled = 16;
    // Numbers from a pixel to the next: pixels lie in different banks, and fragments where they may begin.
    static __host__ __device__ int stride(int channels) { return channels + filled; }
    static size_t bytes(int channels) {
        return size_t(wide * high) * size_t(stride(channels)) * sizeof(__half);
    }
    static __device__ void load(__half* own, const JoinedImage& x, int image, int top, int left, int first,
                                int channels) {
        const int groups = channels / eight;
        for (int k = int(threadIdx.x); k < wide * high * groups; k += int(blockDim.x)) {
            const int pixel = k / groups, c = k % groups * eight, row = top - reach + pixel / wide,
                      column = left - reach + pixel % wide;
            Eight of{};
            if (row >= 0 && row < x.height && column >= 0 && column < x.width)
                of = eight_of(x, image, row, column, first + c);
            *reinterpret_cast<Eight*>(own + pixel * stride(channels) + c) = of;
        }
    }
};

// Sums of products of a tile's pixels, `down` rows of `across`, with `columns` outputs of a weight (outputs,
// 5, 5, all): each warp takes some of the taps and channels. sums (warp, pixel, columns).
template <int across, int down, int columns, int outputs>
__device__ void multiply(const __half* own, int channels, const __half* weight, int all, float* sums) {
    constexpr int deep = 16, fragments = columns / outputs, warp = 32;
    const int warps = int(blockDim.x) / warp, mine = int(threadIdx.x) / warp, parts = channels / deep,
              stride = Tile<across, down>::stride(channels);
    wmma::fragment<wmma::accumulator, across, outputs, deep, float> sum[down][fragments];
    for (auto& row : sum)
        for (auto& f : row) wmma::fill_fragment(f, 0.f);
#pragma unroll 2
    for (int chunk = mine; chunk < taps * taps * parts; chunk += warps) {
        const int tap = chunk / parts, part = chunk % parts;
        wmma::fragment<wmma::matrix_b, across, outputs, deep, __half, wmma::col_major> b[fragments];
        for (int f = 0; f < fragments; ++f)
            wmma::load_matrix_sync(
                b[f], weight + size_t(f * outputs) * (taps * taps * all) + tap * all + part * deep,
                unsigned(taps * taps * all));
        for (int row = 0; row < down; ++row) {
            wmma::fragment<wmma::matrix_a, across, outputs, deep, __half, wmma::row_major> a;
            wmma::load_matrix_sync(
                a, own + ((row + tap / taps) * Tile<across, down>::wide + tap % taps) * stride + part * deep,
                unsigned(stride));
            for (int f = 0; f < fragments; ++f) wmma::mma_sync(sum[row][f], a, b[f], sum[row][f]);
        }
    }
    __syncthreads();  // the sums may lie where the tile did
    for (int row = 0; row < down; ++row)
        for (int f = 0; f < fragments; ++f)
            wmma::store_matrix_sync(sums + ((mine * down + row) * across) * columns + f * outputs,
                                    sum[row][f], columns, wmma::mem_row_major);
    __syncthreads();
}

// 64 outputs of a tile and some of its channels. What other blocks add up of the same is gathered by the one
// that comes last, in their order.
constexpr int across = 8, down = 4, columns = 64, warps = threads_a_block / 32;
using SmallTile = Tile<across, down>;

__global__ void __launch_bounds__(threads_a_block)
    convolve_kernel(const JoinedImage x, const __half* weight, const __half* bias, int outputs, int splits,
                    int tiles_across, int tiles_down, float* partial, unsigned* counters, __half* out) {
    extern __shared__ __align__(32) unsigned char own[];
    __shared__ bool last;
    const int all = x.doubled_channels + x.skip_channels, channels = all / splits, tile = int(blockIdx.x),
              image = tile / (tiles_across * tiles_down), top = tile / tiles_across % tiles_down * down,
              left = tile % tiles_across * across, split = int(blockIdx.z),
              column = int(blockIdx.y) * columns;
    __half* const pixels = reinterpret_cast<__half*>(own);
    float* const sums = reinterpret_cast<float*>(own);
    SmallTile::load(pixels, x, image, top, left, split * channels, channels);
    __syncthreads();
    multiply<across, down, columns, 32>(
        pixels, channels, weight + size_t(column) * (taps * taps * all) + split * channels, all, sums);
    constexpr int each = across * down * columns;
    auto finish = [&](int k, float sum) {
        const int row = top + k / columns / across, at = left + k / columns % across,
                  c = column + k % columns;
        if (row < x.height && at < x.width)
            out[((size_t(image) * x.height + row) * x.width + at) * outputs + c] =
                __float2half_rn(fmaxf(sum + __half2float(bias[c]), 0.f));
    };
    auto of_warps = [&](int k) {
        float sum = 0;
        for (int w = 0; w < warps; ++w) sum += sums[w * each + k];
        return sum;
    };
    if (splits == 1) {
        for (int k = int(threadIdx.x); k < each; k += threads_a_block) finish(k, of_warps(k));
        return;
    }
    const size_t place = size_t(blockIdx.y) * gridDim.x + blockIdx.x;
    float* const between = partial + place * splits * each;
    for (int k = int(threadIdx.x); k < each; k += threads_a_block) between[split * each + k] = of_warps(k);
    __threadfence();
    __syncthreads();
    if (threadIdx.x == 0) last = atomicAdd(&counters[place], 1u) + 1 == unsigned(splits);
    __syncthreads();
    if (!last) return;
    __threadfence();
    for (int k = int(threadIdx.x); k < each; k += threads_a_block) {
        float sum = 0;
        for (int s = 0; s < splits; ++s) sum += __ldcg(&between[s * each + k]);
        finish(k, sum);
    }
    if (threadIdx.x == 0) counters[place] = 0;
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

constexpr int last_across = 32, last_down = 4, most_outputs = 8;
using LastTile = Tile<last_across, last_down>;

__global__ void __launch_bounds__(threads_a_block)
    last_kernel(const JoinedImage x, const __half* weight, const float* bias, int outputs, const float* base,
                int height, int width, int tiles_across, int tiles_down, float* out) {
    extern __shared__ __align__(32) unsigned char own[];
    const int tile = int(blockIdx.x), image = tile / (tiles_across * tiles_down),
              top = tile / tiles_across % tiles_down * last_down, left = tile % tiles_across * last_across;
    __half* const pixels = reinterpret_cast<__half*>(own);
    float* const sums = reinterpret_cast<float*>(own);
    LastTile::load(pixels, x, image, top, left, 0, x.skip_channels);
    __syncthreads();
    multiply<last_across, last_down, most_outputs, most_outputs>(pixels, x.skip_channels, weight,
                                                                 x.skip_channels, sums);
    constexpr int all = last_across * last_down;
    for (int k = int(threadIdx.x); k < all * outputs; k += threads_a_block) {
        const int c = k / all, pixel = k % all, row = top + pixel / last_across,
                  column = left + pixel % last_across;
        if (row >= height || column >= width) continue;
        float sum = 0;
        for (int w = 0; w < warps; ++w) sum += sums[(w * all + pixel) * most_outputs + c];
        const size_t plane = size_t(image) * outputs + c;
        sum += bias[c];
        if (base)
            sum += doubled_at(base + plane * (height / 2) * (width / 2), height / 2, width / 2, row, column);
        out[(plane * height + row) * width + column] = sum;
    }
}

// Of a block whose tile lies where its warps' sums do afterwards.
template <class Kernel>
size_t shared_by(Kernel* kernel, size_t tile, size_t sums) {
    const size_t bytes = tile > sums ? tile : sums;
    check_cuda(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, int(bytes)),
               "memory of a processor");
    return bytes;
}

int parts(int whole, int part) { return (whole + part - 1) / part; }

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

ConvolutionPlan plan_of_convolution(const JoinedImage& x, int outputs) {
    constexpr int deep = 16, busy = 128;  // channels of a fragment; blocks
    constexpr double most_read = 40e6;    // bytes of weights, by all tiles
    const int all = x.channels(), tiles = x.images * parts(x.height, down) * parts(x.width, across);
    const double reads = double(tiles) * outputs * taps * taps * all * sizeof(__half);
    if (all % deep != 0 || outputs % columns != 0 || reads > most_read) return {};
    const int places = tiles * (outputs / columns);
    int splits = 1;
    // As many as leave each some fragments.
    for (int k = 2; k <= all / deep && places * splits < busy; ++k)
        if (all / deep % k == 0) splits = k;
    return {tiles, places, splits, size_t(places) * size_t(splits) * across * down * columns};
}

void launch_convolution(const ConvolutionPlan& plan, const JoinedImage& x, const void* weight,
                        const void* bias, int outputs, float* partial, unsigned* counters, void* out,
                        cudaStream_t stream) {
    const size_t bytes = shared_by(convolve_kernel, SmallTile::bytes(x.channels() / plan.splits),
                                   size_t(warps) * across * down * columns * sizeof(float));
    const dim3 blocks(unsigned(plan.tiles), unsigned(outputs / columns), unsigned(plan.splits));
    convolve_kernel<<<blocks, threads_a_block, bytes, stream>>>(
        x, static_cast<const __half*>(weight), static_cast<const __half*>(bias), outputs, plan.splits,
        parts(x.width, across), parts(x.height, down), partial, counters, static_cast<__half*>(out));
    check_cuda(cudaGetLastError(), "launch of a convolution");
}

void launch_last(int images, int H, int W, int C, const void* x, const void* weight, const float* bias,
                 int outputs, const float* base, int height, int width, float* out, cudaStream_t stream) {
    const JoinedImage image{images, H, W, nullptr, x, 0, C};
    const int tiles_across = parts(width, last_across), tiles_down = parts(height, last_down);
    const size_t bytes = shared_by(last_kernel, LastTile::bytes(C),
                                   size_t(warps) * last_across * last_down * most_outputs * sizeof(float));
    last_kernel<<<unsigned(images * tiles_across * tiles_down), threads_a_block, bytes, stream>>>(
        image, static_cast<const __half*>(weight), bias, outputs, base, height, width, tiles_across,
        tiles_down, out);
    check_cuda(cudaGetLastError(), "launch of the last convolution");
}

}  // namespace wetcurl
