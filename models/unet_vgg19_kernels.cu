// UnetVgg19 on tensor cores: 5x5 convolutions as products of pixels by channels and of channels by outputs.
#include <cooperative_groups.h>
#include <cuda_fp16.h>
#include <cuda_pipeline.h>

#include <algorithm>
#include <cuda/ptx>
#include <string>

#include "base/device_buffer.h"
#include "models/unet_vgg19_kernels.h"

namespace wetcurl {

namespace {

namespace cg = cooperative_groups;
namespace ptx = cuda::ptx;

constexpr int side = 5, reach = side / 2;
constexpr int eight = 8;                                             // numbers, read and written at once
constexpr int deep = channels_at_once;                               // of one tap: what one product goes over
constexpr int outputs = outputs_at_once;                             // of a block
constexpr int warp = 32, of_group = 4 * warp, pixels_of_group = 64;  // a group makes a product together

struct alignas(16) Eight {
    __half2 of[4];
};

__host__ __device__ constexpr int parts_of(int whole, int part) { return (whole + part - 1) / part; }

// A tile of an image, and the pixels around it, as a block of threads holds them.
template <int across_, int down_>
struct Tile {
    static constexpr int across = across_, down = down_, pixels = across * down, wide = across + 2 * reach,
                         high = down + 2 * reach, held = wide * high;
    // Numbers from a held pixel to the next: of 16 bytes, an odd number of them.
    static __host__ __device__ int stride(int channels) { return channels + eight; }
    static size_t bytes(int channels) { return size_t(held) * size_t(stride(channels)) * sizeof(__half); }
    static unsigned number(const JoinedImage& x) {
        return unsigned(x.images) * unsigned(parts_of(x.width, across)) * unsigned(parts_of(x.height, down));
    }

    int image, top, left;  // where it begins
    __device__ Tile(const JoinedImage& x, int k) {
        const int tiles_across = parts_of(x.width, across), tiles_down = parts_of(x.height, down);
        image = k / (tiles_across * tiles_down), top = k / tiles_across % tiles_down * down,
        left = k % tiles_across * across;
    }
    // Channels first .. first + channels - 1 are on their way to `to`, asked for by all threads; 0 beyond the
    // image.
    __device__ void fetch(const JoinedImage& x, int first, int channels, __half* to) const {
        const int eights = channels / eight;
        const float inverse = 1.0f / float(eights);
        for (int k = int(threadIdx.x); k < held * eights; k += int(blockDim.x)) {
            const int pixel = int((float(k) + 0.5f) * inverse), c = (k - pixel * eights) * eight,
                      row = top - reach + pixel / wide, column = left - reach + pixel % wide;
            const bool there = row >= 0 && row < x.height && column >= 0 && column < x.width;
            __pipeline_memcpy_async(to + pixel * stride(channels) + c,
                                    x.eight_at(image, there ? row : 0, there ? column : 0, first + c),
                                    sizeof(Eight), there ? 0 : sizeof(Eight));
        }
        __pipeline_commit();
    }
};

// A block of threads: groups of them, one warp that asks for weights, and what they share. Of `turns` times
// `lots` groups a lot has 64 pixels, and those who have the same take rows of taps in turn.
template <int lots_, int turns_, int across>
struct Block {
    static constexpr int lots = lots_, turns = turns_, groups = lots * turns,
                         threads = groups * of_group + warp;
    using Tile = wetcurl::Tile<across, lots * pixels_of_group / across>;
    static constexpr int line = outputs + eight;  // numbers from a pixel's sums to the next one's

    // Weights of a row of taps, 16 channels: (tap, 2, output, 8). So many rows are on their way at once.
    static constexpr int of_tap = outputs * deep, of_row = side * of_tap, rows_at_once = turns > 1 ? 8 : 5;
    struct Ring {
        alignas(128) __half row[rows_at_once][of_row];
    };
    // The ring and the tile; then the sums in their place.
    static size_t bytes(int channels) {
        return std::max(sizeof(Ring) + Tile::bytes(channels), size_t(Tile::pixels) * line * sizeof(float));
    }
};

#if defined(__CUDA_ARCH_FEAT_SM90_ALL)
__device__ unsigned address_of(const void* shared) { return unsigned(__cvta_generic_to_shared(shared)); }

// Four matrices of 8x8, a row of each from every eighth lane.
__device__ void load_matrices(uint32_t (&to)[4], unsigned from) {
    asm volatile("ldmatrix.sync.aligned.m8n8.x4.shared.b16 {%0, %1, %2, %3}, [%4];"
                 : "=r"(to[0]), "=r"(to[1]), "=r"(to[2]), "=r"(to[3])
                 : "r"(from));
}

// Of PTX's matrices in shared memory: (2, outputs, 8) at an address, rows of 16 bytes.
__device__ uint64_t described(unsigned address) {
    constexpr uint64_t unit = 16, to_next_half = outputs * eight * sizeof(__half) / unit,
                       to_next_eight = eight * eight * sizeof(__half) / unit;
    constexpr unsigned reach_of_addresses = 1u << 18;
    return uint64_t(address % reach_of_addresses / unit) | to_next_half << 16 | to_next_eight << 32;
}
// Adds (64 pixels, 16 channels) by (16 channels, 64 outputs): lanes hold the former and the sums.
__device__ void add_product(float (&d)[32], const uint32_t (&a)[4], uint64_t b) {
    asm volatile(
        "{.reg .pred p; setp.ne.b32 p, 1, 0;"
        "wgmma.mma_async.sync.aligned.m64n64k16.f32.f16.f16 "
        "{%0, %1, %2, %3, %4, %5, %6, %7, %8, %9, %10, %11, %12, %13, %14, %15, "
        "%16, %17, %18, %19, %20, %21, %22, %23, %24, %25, %26, %27, %28, %29, %30, %31}, "
        "{%32, %33, %34, %35}, %36, p, 1, 1, 0;}"
        : "+f"(d[0]), "+f"(d[1]), "+f"(d[2]), "+f"(d[3]), "+f"(d[4]), "+f"(d[5]), "+f"(d[6]), "+f"(d[7]),
          "+f"(d[8]), "+f"(d[9]), "+f"(d[10]), "+f"(d[11]), "+f"(d[12]), "+f"(d[13]), "+f"(d[14]),
          "+f"(d[15]), "+f"(d[16]), "+f"(d[17]), "+f"(d[18]), "+f"(d[19]), "+f"(d[20]), "+f"(d[21]),
          "+f"(d[22]), "+f"(d[23]), "+f"(d[24]), "+f"(d[25]), "+f"(d[26]), "+f"(d[27]), "+f"(d[28]),
          "+f"(d[29]), "+f"(d[30]), "+f"(d[31])
        : "r"(a[0]), "r"(a[1]), "r"(a[2]), "r"(a[3]), "l"(b));
}
// Adds (16 pixels, 16 channels) by (16 channels, 8 columns).
__device__ void add_small_product(float (&d)[4], const uint32_t (&a)[4], uint32_t b0, uint32_t b1) {
    asm("mma.sync.aligned.m16n8k16.row.col.f32.f16.f16.f32 {%0, %1, %2, %3}, {%4, %5, %6, %7}, {%8, %9}, "
        "{%0, %1, %2, %3};"
        : "+f"(d[0]), "+f"(d[1]), "+f"(d[2]), "+f"(d[3])
        : "r"(a[0]), "r"(a[1]), "r"(a[2]), "r"(a[3]), "r"(b0), "r"(b1));
}
// Products are made while threads go on; what they read stays as it is until they are waited for.
__device__ void products_begin() { asm volatile("wgmma.fence.sync.aligned;" ::: "memory"); }
__device__ void products_end() { asm volatile("wgmma.commit_group.sync.aligned;" ::: "memory"); }
template <int left>
__device__ void wait_for_products() {
    asm volatile("wgmma.wait_group.sync.aligned %0;" ::"n"(left) : "memory");
}

// The sums of the block's tile over channels first .. first + channels - 1, (pixel, line) in shared memory.
// weight: of its outputs, from these channels on.
template <class Block>
__device__ float* sums_of(const JoinedImage& x, const typename Block::Tile& tile, const __half* weight,
                          int first, int channels, unsigned char* own) {
    using Tile = typename Block::Tile;
    using Ring = typename Block::Ring;
    constexpr int rows_at_once = Block::rows_at_once;
    __shared__ uint64_t full[rows_at_once], empty[rows_at_once];
    Ring& ring = *reinterpret_cast<Ring*>(own);
    __half* const held = reinterpret_cast<__half*>(own + sizeof(Ring));
    const int thread = int(threadIdx.x), lane = thread % warp, group = thread / of_group,
              lot = group % Block::lots, turn = group / Block::lots, stride = Tile::stride(channels),
              rows = channels / deep * side;
    auto fetch = [&](int row) {
        const int slot = row % rows_at_once;
        constexpr uint32_t bytes = sizeof ring.row[0];
        ptx::mbarrier_arrive_expect_tx(ptx::sem_release, ptx::scope_cta, ptx::space_shared, &full[slot],
                                       bytes);
        ptx::cp_async_bulk(ptx::space_cluster, ptx::space_global, ring.row[slot],
                           weight + size_t(row) * Block::of_row, bytes, &full[slot]);
    };
    auto wait = [](uint64_t* those, int row) {
        while (!ptx::mbarrier_try_wait_parity(&those[row % rows_at_once], row / rows_at_once % 2)) {
        }
    };
    if (thread == Block::groups * of_group) {
        for (int slot = 0; slot < rows_at_once; ++slot)
            ptx::mbarrier_init(&full[slot], 1),
                ptx::mbarrier_init(&empty[slot], Block::lots * of_group / warp);
        ptx::fence_mbarrier_init(ptx::sem_release, ptx::scope_cluster);
        for (int row = 0; row < min(rows_at_once, rows); ++row) fetch(row);
    }
    cudaGridDependencySynchronize();  // now x is there
    tile.fetch(x, first, channels, held);
    __pipeline_wait_prior(0);
    __syncthreads();

    float sum[outputs / 2] = {};
    if (group < Block::groups) {
        const int pixel = lot * pixels_of_group + thread % of_group / warp * deep + lane % 16;
        const unsigned from = address_of(
            held + (pixel / Tile::across * Tile::wide + pixel % Tile::across) * stride + lane / 16 * eight);
        // Pixels of some taps are read while the products of others are made: rows of taps, or parts of one
        // where other blocks are there to go on meanwhile.
        constexpr bool whole = Block::lots == 1;
        constexpr int first_part = whole ? side : 3;
        uint32_t one[first_part][4], other[whole ? side : side - first_part][4];
        auto read = [&](int row, int begin, auto& to) {
            if (row >= rows) return;
            int at_tap = (row % side * Tile::wide + begin) * stride + row / side * deep;
#pragma unroll
            for (auto& a : to)
                load_matrices(a, from + unsigned(at_tap * int(sizeof(__half)))), at_tap += stride;
        };
        auto add = [&](int row, int begin, const auto& those) {
            if (begin == 0) wait(full, row);
            unsigned weights = address_of(ring.row[row % rows_at_once]) +
                               unsigned(begin * Block::of_tap * int(sizeof(__half)));
            products_begin();
#pragma unroll
            for (const auto& a : those)
                add_product(sum, a, described(weights)),
                    weights += unsigned(Block::of_tap * int(sizeof(__half)));
            products_end();
            wait_for_products<1>();
            if (begin == 0 && lane == 0 && row >= Block::turns)
                ptx::mbarrier_arrive(&empty[(row - Block::turns) % rows_at_once]);
        };
        constexpr int next = Block::turns;
        read(turn, 0, one);
        if constexpr (whole) {
            for (int row = turn; row < rows; row += 2 * next) {
                add(row, 0, one), read(row + next, 0, other);
                if (row + next < rows) add(row + next, 0, other), read(row + 2 * next, 0, one);
            }
        } else {
            for (int row = turn; row < rows; row += next) {
                add(row, 0, one), read(row, first_part, other);
                add(row, first_part, other), read(row + next, 0, one);
            }
        }
        wait_for_products<0>();
    } else if (lane == 0) {
        for (int row = rows_at_once; row < rows; ++row) wait(empty, row - rows_at_once), fetch(row);
    }
    cudaTriggerProgrammaticLaunchCompletion();  // the next may ask for its weights
    __syncthreads();
    float* const sums = reinterpret_cast<float*>(own);
    for (int now = 0; now < Block::turns; ++now) {
        if (now == turn) {
            float* to = sums +
                        (lot * pixels_of_group + thread % of_group / warp * 16 + lane / 4) * Block::line +
                        2 * (lane % 4);
#pragma unroll
            for (int j = 0; j < outputs / eight; ++j)
#pragma unroll
                for (int l = 0; l < 2; ++l) {
                    float2& all = *reinterpret_cast<float2*>(to + 8 * l * Block::line + eight * j);
                    float2 mine{sum[4 * j + 2 * l], sum[4 * j + 2 * l + 1]};
                    if (now > 0) mine.x += all.x, mine.y += all.y;
                    all = mine;
                }
        }
        __syncthreads();
    }
    return sums;
}
// ReLU, which NaN gets through.
__device__ float rectified(float x) { return x < 0 ? 0 : x; }

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

#endif

// Blocks of a cluster share out the channels, `channels` each, and add up what they find.
template <class Block>
__global__ void __launch_bounds__(Block::threads)
    convolve(const JoinedImage x, const __half* __restrict__ weight, const __half* __restrict__ bias,
             int all_outputs, int channels, int blocks, __half* __restrict__ out,
             __half* __restrict__ pooled) {
#if defined(__CUDA_ARCH_FEAT_SM90_ALL)
    extern __shared__ __align__(128) unsigned char own[];
    using Tile = typename Block::Tile;
    const int rank = int(blockIdx.x) % blocks, number = int(blockIdx.x) / blocks,
              begin = int(blockIdx.y) * outputs;
    const size_t rows = size_t(blockIdx.y) * (x.channels() / deep * side) + rank * (channels / deep * side);
    const float* const sums =
        sums_of<Block>(x, Tile(x, number), weight + rows * Block::of_row, rank * channels, channels, own);
    // A warp takes four pixels, 2x2, eight lanes each.
    auto put = [&](auto of_block) {
        const Tile at(x, number);
        const int lane = int(threadIdx.x) % warp, c = lane % eight * eight, right = lane / eight % 2,
                  below = lane / (2 * eight);
        const Eight shift = *reinterpret_cast<const Eight*>(bias + begin + c);
        constexpr int quads = Tile::across / 2;
        for (int k = (rank * Block::threads + int(threadIdx.x)) / warp; k < Tile::pixels / 4;
             k += blocks * (Block::threads / warp)) {
            const int down = k / quads * 2 + below, over = k % quads * 2 + right, row = at.top + down,
                      column = at.left + over;
            float2 all[4];
#pragma unroll
            for (int l = 0; l < 4; ++l) all[l] = __half22float2(shift.of[l]);
            for (int b = 0; b < blocks; ++b) {
                const float4* from = reinterpret_cast<const float4*>(
                    of_block(b) + (down * Tile::across + over) * Block::line + c);
                const float4 p = from[0], q = from[1];
                all[0].x += p.x, all[0].y += p.y, all[1].x += p.z, all[1].y += p.w;
                all[2].x += q.x, all[2].y += q.y, all[3].x += q.z, all[3].y += q.w;
            }
            Eight result;
#pragma unroll
            for (int l = 0; l < 4; ++l)
                result.of[l] = __floats2half2_rn(rectified(all[l].x), rectified(all[l].y));
            const bool there = row < x.height && column < x.width;
            const size_t image = size_t(at.image) * x.height;
            if (there)
                *reinterpret_cast<Eight*>(out + ((image + row) * x.width + column) * all_outputs + begin +
                                          c) = result;
            if (!pooled) continue;
#pragma unroll
            for (int other = eight; other < warp; other *= 2)
#pragma unroll
                for (__half2& most : result.of)
                    most = __hmax2_nan(most, __shfl_xor_sync(0xffffffffu, most, other));
            if (there && lane < eight)
                *reinterpret_cast<Eight*>(
                    pooled + ((image / 2 + row / 2) * (x.width / 2) + column / 2) * all_outputs + begin + c) =
                    result;
        }
    };
    if (blocks == 1) return put([&](int) { return sums; });
    const auto cluster = cg::this_cluster();
    cluster.sync();
    put([&](int b) { return cluster.map_shared_rank(sums, b); });
    cluster.sync();  // nobody's memory goes before all have read it
#endif
}

// The last one has few outputs: of each pixel of a tile and around it all taps are products of their own,
// that of an output and a tap a column, and outputs gather theirs.
using LastTile = Tile<16, 8>;
constexpr int of_last = 8 * warp,
              last_line = last_columns + 1;  // sums of pixels lie in different banks
static_assert(last_columns % deep == 0 && last_columns >= side * side * most_last_outputs);

size_t last_bytes(int channels) {
    return std::max(
        LastTile::bytes(channels) + size_t(last_columns) * LastTile::stride(channels) * sizeof(__half),
        size_t(LastTile::held) * last_line * sizeof(float));
}

__global__ void __launch_bounds__(of_last, 2)
    convolve_last(const JoinedImage x, const __half* __restrict__ weight, const float* __restrict__ bias,
                  int all_outputs, const float* base, int height, int width, float* out) {
#if defined(__CUDA_ARCH_FEAT_SM90_ALL)
    extern __shared__ __align__(128) unsigned char own[];
    const int thread = int(threadIdx.x), lane = thread % warp, channels = x.channels(),
              stride = LastTile::stride(channels), eights = channels / eight;
    __half *const held = reinterpret_cast<__half*>(own), *const weights = held + LastTile::held * stride;
    for (int k = thread; k < last_columns * eights; k += of_last)
        __pipeline_memcpy_async(weights + k / eights * stride + k % eights * eight, weight + k * eight,
                                sizeof(Eight));
    cudaGridDependencySynchronize();  // now x is there
    const LastTile tile(x, int(blockIdx.x));
    tile.fetch(x, 0, channels, held);
    __pipeline_wait_prior(0);
    __syncthreads();
    // A warp takes 16 pixels at a time.
    constexpr int lots = parts_of(LastTile::held, deep), each = parts_of(lots, of_last / warp),
                  pairs = last_columns / deep;
    float sum[each][2 * pairs][4] = {};
    auto lot_of = [&](int i) { return thread / warp + i * (of_last / warp); };
    for (int k = 0; k < channels; k += deep) {
        uint32_t a[each][4];
#pragma unroll
        for (int i = 0; i < each; ++i)
            load_matrices(a[i], address_of(held + (min(lot_of(i), lots - 1) * deep + lane % 16) * stride + k +
                                           lane / 16 * eight));
#pragma unroll
        for (int j = 0; j < pairs; ++j) {
            uint32_t b[4];
            load_matrices(b, address_of(weights + (j * deep + lane / 16 * 8 + lane % 8) * stride + k +
                                        lane / 8 % 2 * eight));
#pragma unroll
            for (int i = 0; i < each; ++i)
                add_small_product(sum[i][2 * j], a[i], b[0], b[1]),
                    add_small_product(sum[i][2 * j + 1], a[i], b[2], b[3]);
        }
    }
    __syncthreads();
    float* const sums = reinterpret_cast<float*>(own);
#pragma unroll
    for (int i = 0; i < each; ++i)
#pragma unroll
        for (int j = 0; j < 2 * pairs; ++j)
#pragma unroll
            for (int l = 0; l < 4; ++l)
                if (lot_of(i) < lots)
                    sums[(lot_of(i) * deep + l / 2 * 8 + lane / 4) * last_line + eight * j + 2 * (lane % 4) +
                         l % 2] = sum[i][j][l];
    __syncthreads();
    for (int k = thread; k < LastTile::pixels * all_outputs; k += of_last) {
        const int c = k / LastTile::pixels, down = k % LastTile::pixels / LastTile::across,
                  over = k % LastTile::across, row = tile.top + down, column = tile.left + over;
        if (row >= height || column >= width) continue;
        float all = bias[c];
        for (int dy = 0; dy < side; ++dy)
#pragma unroll
            for (int dx = 0; dx < side; ++dx)
                all += sums[((down + dy) * LastTile::wide + over + dx) * last_line +
                            (dy * side + dx) * all_outputs + c];
        const size_t plane = size_t(tile.image) * all_outputs + c;
        if (base)
            all += doubled_at(base + plane * (height / 2) * (width / 2), height / 2, width / 2, row, column);
        out[(plane * height + row) * width + column] = all;
    }
#endif
}

constexpr int threads_to_take = 256;

// A thread takes eight channels of a pixel.
__global__ void __launch_bounds__(threads_to_take)
    take_kernel(size_t area, int C, int eights, size_t jobs, const float* x, Eight* out) {
    const size_t k = size_t(blockIdx.x) * threads_to_take + threadIdx.x;
    if (k >= jobs) return;
    const size_t pixel = k % area, image = k / area / eights;
    const int first = int(k / area % eights) * eight;
    Eight result;
#pragma unroll
    for (int l = 0; l < 4; ++l) {
        auto channel = [&](int c) { return c < C ? x[(image * C + c) * area + pixel] : 0.f; };
        result.of[l] = __floats2half2_rn(channel(first + 2 * l), channel(first + 2 * l + 1));
    }
    out[(image * area + pixel) * eights + first / eight] = result;
}

int attribute_of_device(cudaDeviceAttr attribute) {
    int device = 0, value = 0;
    check_cuda(cudaGetDevice(&device), "device");
    check_cuda(cudaDeviceGetAttribute(&value, attribute, device), "attribute");
    return value;
}

// A launch of so many blocks, `blocks` of them a cluster. It may begin before the one before has ended, and
// waits for that where it reads what that writes.
struct Launch {
    cudaLaunchAttribute attributes[2];
    cudaLaunchConfig_t config{};
    Launch(dim3 grid, int blocks, int threads, size_t bytes, cudaStream_t stream) {
        attributes[0].id = cudaLaunchAttributeProgrammaticStreamSerialization;
        attributes[0].val.programmaticStreamSerializationAllowed = 1;
        attributes[1].id = cudaLaunchAttributeClusterDimension;
        attributes[1].val.clusterDim = {unsigned(blocks), 1, 1};
        config.gridDim = grid, config.blockDim = unsigned(threads), config.dynamicSmemBytes = bytes;
        config.stream = stream, config.attrs = attributes, config.numAttrs = blocks > 1 ? 2 : 1;
    }
    template <class... Parameters, class... Given>
    void run(void (*kernel)(Parameters...), Given... given) const {
        check_cuda(cudaLaunchKernelEx(&config, kernel, given...), "launch of a convolution");
    }
    template <class Kernel>
    unsigned clusters_at_once(Kernel* kernel) const {
        int count = 0;
        check_cuda(cudaOccupancyMaxActiveClusters(&count, kernel, &config), "clusters");
        return unsigned(count);
    }
};

// How the channels of a convolution of so many tiles are shared out: by as many blocks of a cluster as the
// device runs at once. 0: there is no room.
template <class Block>
int blocks_of_cluster(int channels, unsigned tiles, unsigned groups) {
    const auto kernel = convolve<Block>;
    const size_t room = allow_shared_memory(kernel);
    constexpr int most = 8;  // that devices take everywhere
    int blocks = 0;
    for (int more = 1; more <= most; ++more) {
        if (channels % (more * deep) != 0 || Block::bytes(channels / more) > room) continue;
        const Launch launch(dim3(tiles * unsigned(more), groups), more, Block::threads,
                            Block::bytes(channels / more), nullptr);
        if (blocks == 0 || tiles * groups <= launch.clusters_at_once(kernel)) blocks = more;
    }
    return blocks;
}

// Whether it did.
template <class Block>
bool launched(const JoinedImage& x, const void* weight, const void* bias, int all_outputs, void* out,
              void* pooled, cudaStream_t stream) {
    const unsigned tiles = Block::Tile::number(x), groups = unsigned(all_outputs / outputs);
    const int blocks = blocks_of_cluster<Block>(x.channels(), tiles, groups);
    if (blocks == 0) return false;
    const int channels = x.channels() / blocks;
    Launch(dim3(tiles * unsigned(blocks), groups), blocks, Block::threads, Block::bytes(channels), stream)
        .run(convolve<Block>, x, static_cast<const __half*>(weight), static_cast<const __half*>(bias),
             all_outputs, channels, blocks, static_cast<__half*>(out), static_cast<__half*>(pooled));
    return true;
}

// Of few tiles; of about as many as there are processors; of more, which a processor takes several of at
// once.
using Small = Block<1, 2, 8>;
using Large = Block<2, 2, 16>;
using Many = Block<2, 1, 16>;

}  // namespace

bool can_convolve(int channels) {
    return attribute_of_device(cudaDevAttrComputeCapabilityMajor) == 9 &&
           blocks_of_cluster<Small>(channels, 1, 1) > 0;
}

bool can_launch_last(int channels) {
    return attribute_of_device(cudaDevAttrComputeCapabilityMajor) == 9 &&
           last_bytes(channels) <= allow_shared_memory(convolve_last);
}

void launch_take(int images, int height, int width, int C, int channels, const float* x, void* out,
                 cudaStream_t stream) {
    const size_t area = size_t(height) * width, jobs = size_t(images) * area * size_t(channels / eight);
    take_kernel<<<unsigned((jobs + threads_to_take - 1) / threads_to_take), threads_to_take, 0, stream>>>(
        area, C, channels / eight, jobs, x, static_cast<Eight*>(out));
    check_cuda(cudaGetLastError(), "launch of what takes an image");
}

void launch_convolution(const JoinedImage& x, const void* weight, const void* bias, int all_outputs,
                        void* out, void* pooled, cudaStream_t stream) {
    const unsigned large = Large::Tile::number(x) * unsigned(all_outputs / outputs),
                   processors = unsigned(attribute_of_device(cudaDevAttrMultiProcessorCount));
    const size_t shared = size_t(attribute_of_device(cudaDevAttrMaxSharedMemoryPerMultiprocessor));
    const bool several = large > 2 * processors && 2 * Many::bytes(x.channels()) <= shared;
    if (several && launched<Many>(x, weight, bias, all_outputs, out, pooled, stream)) return;
    if (4 * large > 3 * processors && launched<Large>(x, weight, bias, all_outputs, out, pooled, stream))
        return;
    if (!launched<Small>(x, weight, bias, all_outputs, out, pooled, stream))
        throw Error("a convolution on a CUDA device: found " + std::to_string(x.channels()) +
                    " channels, for which a processor has no room");
}

void launch_last(const JoinedImage& x, const void* weight, const float* bias, int all_outputs,
                 const float* base, int height, int width, float* out, cudaStream_t stream) {
    allow_shared_memory(convolve_last);
    Launch(LastTile::number(x), 1, of_last, last_bytes(x.channels()), stream)
        .run(convolve_last, x, static_cast<const __half*>(weight), bias, all_outputs, base, height, width,
             out);
}

}  // namespace wetcurl
