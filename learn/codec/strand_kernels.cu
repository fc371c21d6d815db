// The strand codec on a CUDA device.
#include <cuda_pipeline.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "learn/codec/edge_lengths.h"
#include "learn/codec/strand_kernels.h"

namespace wetcurl {

namespace {

constexpr int threads = 128, tile = 32, tile_rows = 4;

unsigned blocks_of(int count, int size = threads) { return unsigned((count + size - 1) / size); }

void check_launch(const char* what) { check_cuda(cudaGetLastError(), what); }

// A block: `tile` strands by `tile` particles, turned over in shared memory.
__global__ void __launch_bounds__(tile* tile_rows)
    depart_kernel(const HeadState* head, const Vec3f* __restrict__ p, const float* __restrict__ share,
                  const Vec3f* __restrict__ rest, int low, int n, float4* __restrict__ x) {
    __shared__ float turned[3][tile][tile + 1];
    const int lane = int(threadIdx.x), first = int(blockIdx.x) * tile, begin = int(blockIdx.y) * tile,
              mine = begin + lane;
    const Quatf to_head = conjugate(head->rotation);
    for (int k = int(threadIdx.y); k < tile && first + k < low; k += tile_rows) {
        if (mine >= n) continue;
        const size_t at = size_t(first + k) * n;
        const Vec3f d = share[first + k] * rotate(to_head, p[at + mine] - p[at]) - rest[at + mine];
        turned[0][lane][k] = d.x, turned[1][lane][k] = d.y, turned[2][lane][k] = d.z;
    }
    __syncthreads();
    if (first + lane >= low) return;
    for (int i = int(threadIdx.y); i < tile && begin + i < n; i += tile_rows)
        x[size_t(begin + i) * low + first + lane] = {turned[0][i][lane], turned[1][i][lane],
                                                     turned[2][i][lane], 0};
}

__device__ Vec3f vector_of(const float4& v) { return {v.x, v.y, v.z}; }

// Cores are linear in the strands: an axis of a strand a thread, (n, 4 low) both. `ahead` numbers are read at
// once, since each step waits for the one before.
__global__ void core_kernel(int columns, int n, float beta, const float* __restrict__ x, float* moved) {
    constexpr int ahead = 8;
    const int column = int(blockIdx.x) * threads + int(threadIdx.x);
    if (column >= columns) return;
    x += column, moved += column;
    const int edges = n - 1, early = edges / 2, steps = early + edges;
    const float a = 2 * (1 - beta), b = (1 - beta) * (1 - beta), c = beta * beta;
    // As smooth_mirrored; edge(i) for i < edges.
    const auto smooth = [&](auto edge, auto store) {
        float first = edge(early), d1 = first, d2 = first;
        for (int begin = 0; begin < steps; begin += ahead) {
            float e[ahead];
#pragma unroll
            for (int k = 0; k < ahead; ++k) e[k] = edge(abs(min(begin + k, steps - 1) - early));
#pragma unroll
            for (int k = 0; k < ahead; ++k) {
                if (begin + k >= steps) continue;
                const float d = a * d1 + (c * e[k] - b * d2);
                d2 = d1, d1 = d;
                if (begin + k >= early) store(begin + k - early, d);
            }
        }
    };
    smooth([&](int i) { return x[size_t(i + 1) * columns] - x[size_t(i) * columns]; },
           [&](int i, float d) { moved[size_t(i + 1) * columns] = d; });
    smooth([&](int i) { return moved[size_t(edges - i) * columns]; },
           [&](int i, float d) { moved[size_t(edges - i) * columns] = d; });
    float sum = moved[0] = x[0];
    for (int begin = 1; begin < n; begin += ahead) {
        float d[ahead];
#pragma unroll
        for (int k = 0; k < ahead; ++k) d[k] = moved[size_t(min(begin + k, n - 1)) * columns];
#pragma unroll
        for (int k = 0; k < ahead; ++k)
            if (begin + k < n) moved[size_t(begin + k) * columns] = sum += d[k];
    }
}

constexpr int lost_strands = 32, lost_parts = 8;

// What low-resolution strands have lost of their own; a block takes some, in parts.
__global__ void lost_kernel(int low, int n, const Beside* __restrict__ beside,
                            const float* __restrict__ per_length, const float4* __restrict__ own,
                            const float4* __restrict__ moved, float* __restrict__ lost) {
    __shared__ float part[lost_parts][lost_strands];
    const int s = int(blockIdx.x) * lost_strands + int(threadIdx.x), p = int(threadIdx.y);
    float sum = 0;
    if (s < low) {
        const Beside near = beside[s];
        for (int i = p; i + 1 < n; i += lost_parts) {
            const float4 *from = moved + size_t(i) * low, *to = from + low;
            sum += lost_of_edge(vector_of(own[size_t(i) * low + s]), s, near, [&](int k) {
                return per_length[k] * (vector_of(to[k]) - vector_of(from[k]));
            });
        }
    }
    part[p][threadIdx.x] = sum;
    __syncthreads();
    if (p > 0 || s >= low) return;
    for (int k = 1; k < lost_parts; ++k) sum += part[k][threadIdx.x];
    lost[s] = sum;
}

constexpr int carriers = 32, stages = 4;

__device__ Vec3f scaled(float unit, int16_t x, int16_t y, int16_t z) {
    return {unit * float(x), unit * float(y), unit * float(z)};
}

// 16 bytes on their way through the nearest cache, where lanes that ask for the same find it: those of
// __pipeline_memcpy_async go past it.
__device__ void fetch_shared(void* to, const void* from) {
    asm volatile("cp.async.ca.shared.global [%0], [%1], 16;" ::"r"(unsigned(__cvta_generic_to_shared(to))),
                 "l"(from)
                 : "memory");
}

// Where wet low-resolution strands are kept as they are, that of a pixel.
struct Kept {
    const int* low;          // (pixel): low-resolution strand or -1; null: none is kept
    const float4 *rest, *x;  // (n, low): offsets from the root at rest; how far from there
};

// A strand goes along its particles one by one. Its amplitudes add up, `basis` (n, 24) those of unit offsets.
__global__ void __launch_bounds__(carriers)
    carry_kernel(int pixels, int low, int n, int width, const int* __restrict__ strand,
                 const RestUnits* __restrict__ units, const RestEdge* __restrict__ edges,
                 const RestDetail* __restrict__ details, const int* __restrict__ from,
                 const float* __restrict__ weight, const float* __restrict__ lost_weight,
                 const float* __restrict__ lost, const Quatf* __restrict__ turn,
                 const float* __restrict__ per_length, const float* __restrict__ per_low_length,
                 const float4* __restrict__ moved, const Kept kept, const float4* __restrict__ basis,
                 float* __restrict__ base, float* __restrict__ dynamic) {
    // A device sees the layout's numbers alone.
    constexpr int first_amplitude = dynamic_layout.base.first, first_doubt = dynamic_layout.doubt.first;
    constexpr int most = Stencil::widest;
    const int s = int(blockIdx.x) * carriers + int(threadIdx.x);
    if (s >= pixels || strand[s] < 0) return;
    int neighbour[most];
    const float per = per_length[s];
    // A low-resolution strand moves this one as much as their lengths say.
    float share[most], scale[most], lost_here = 0;
    for (int k = 0; k < most; ++k) {
        neighbour[k] = k < width ? from[k * pixels + s] : neighbour[0];
        share[k] = k < width ? weight[k * pixels + s] : 0;
        scale[k] = per_low_length[neighbour[k]] / per;
        if (k < width) lost_here += lost_weight[k * pixels + s] * lost[neighbour[k]];
    }
    const RestUnits unit_of = units[s];
    const Quatf to_root = conjugate(turn[s]);
    const size_t out = size_t(n) * pixels;
    const int twin = kept.low ? kept.low[s] : -1;
    int doubted[doubt_places];
#pragma unroll
    for (int place = 0; place < doubt_places; ++place) doubted[place] = doubt_particle(n, place);
    // What the next particles need is on its way: a ring of them, a lane each, but for what all lanes share.
    struct Stage {
        RestEdge edge[carriers];
        float4 moved[most][carriers];
        RestDetail detail[carriers];
    };
    __shared__ Stage ring[stages];
    const int lane = int(threadIdx.x);
    const auto fetch = [&](int i) {
        Stage& to = ring[i % stages];
        if (i < n) {
            const size_t at = size_t(i) * pixels + s;
            __pipeline_memcpy_async(&to.edge[lane], edges + at, sizeof(RestEdge));
            __pipeline_memcpy_async(&to.detail[lane], details + at, sizeof(RestDetail));
#pragma unroll
            for (int k = 0; k < most; ++k)
                fetch_shared(&to.moved[k][lane], moved + (size_t(i) * low + neighbour[k]));
        }
        __pipeline_commit();
    };
    for (int i = 0; i < stages; ++i) fetch(i);
    constexpr int quads = dct_kept / 4;
    float4 basis_ahead[quads];
    const auto fetch_basis = [&](int i) {
#pragma unroll
        for (int m = 0; m < quads; ++m) basis_ahead[m] = __ldg(basis + i * quads + m);
    };
    fetch_basis(0);
    Vec3f amplitude[dct_kept] = {};
    lost_here = fminf(fmaxf(lost_here, 0), 1);
    dynamic[size_t(first_doubt + doubt_places) * pixels + s] = lost_here;
    carry_rest<float>(
        n, lost_here,
        [&](int i) {
            const RestEdge e = ring[i % stages].edge[lane];
            const RestDetail d = ring[i % stages].detail[lane];
            const Vec3f curled = scaled(unit_of.curled, e.curled[0], e.curled[1], e.curled[2]);
            return RestParticle<float>{scaled(unit_of.edge, e.edge[0], e.edge[1], e.edge[2]), norm(curled),
                                       curled, scaled(unit_of.detail, d.detail[0], d.detail[1], d.detail[2]),
                                       scaled(unit_of.own, e.own_xy[0], e.own_xy[1], d.own_z)};
        },
        // Asked for in order, before that particle's rest and after the one before's, whose place is free.
        [&](int i) {
            if (i > 0) fetch(i - 1 + stages);
            __pipeline_wait_prior(stages - 1);
            Vec3f sum{0, 0, 0};
#pragma unroll
            for (int k = 0; k < most; ++k)
                sum += share[k] * scale[k] * vector_of(ring[i % stages].moved[k][lane]);
#pragma unroll
            for (int place = 0; place < doubt_places; ++place) {
                if (i != doubted[place]) continue;
                float square = 0;
#pragma unroll
                for (int k = 0; k < most; ++k) {
                    const Vec3f apart = scale[k] * vector_of(ring[i % stages].moved[k][lane]) - sum;
                    square += share[k] * dot(apart, apart);
                }
                dynamic[size_t(first_doubt + place) * pixels + s] = per * sqrtf(square);
            }
            return rotate(to_root, sum);
        },
        [&](int i, Vec3f x) {
            if (twin >= 0) {
                const size_t k = size_t(i) * low + twin;
                x = rotate(to_root, vector_of(kept.rest[k]) + vector_of(kept.x[k]));
            }
            const size_t at = size_t(i) * pixels + s;
            base[at] = x.x, base[out + at] = x.y, base[2 * out + at] = x.z;
#pragma unroll
            for (int m = 0; m < quads; ++m) {
                const float4 u = basis_ahead[m];
                Vec3f* const to = amplitude + 4 * m;
                to[0] += u.x * x, to[1] += u.y * x, to[2] += u.z * x, to[3] += u.w * x;
            }
            fetch_basis(min(i + 1, n - 1));
        });
#pragma unroll
    for (int m = 0; m < dct_kept; ++m) {
        float* to = dynamic + size_t(first_amplitude + m) * pixels + s;
        const Vec3f a = per * amplitude[m];
        to[0] = a.x, to[size_t(dct_kept) * pixels] = a.y, to[size_t(2 * dct_kept) * pixels] = a.z;
    }
}

// Frames before one that are seen.
struct Lags {
    static constexpr int count = int(history_lags.size());
    int frames[count], slots;
};

// A block of strands describes one number of their history, or, as the last, gravity and their motion.
__global__ void describe_kernel(const HeadState* head, int pixels, const int* __restrict__ strand,
                                const Quatf* __restrict__ turn, const Vec3f* __restrict__ root,
                                const float* __restrict__ swing, const Lags lags, float* past,
                                float* dynamic) {
    // A device sees the layout's numbers alone.
    constexpr int base = dynamic_layout.base.first, gravity = dynamic_layout.gravity.first,
                  turning = dynamic_layout.turning.first, pull = dynamic_layout.acceleration.first,
                  history = dynamic_layout.history.first, numbers = past_layout.count,
                  modes = past_layout.change.end(), past_turning = past_layout.turning.first - modes,
                  past_pull = past_layout.acceleration.first - modes;
    static_assert(past_layout.change.first == 0);
    const int s = int(blockIdx.x) * threads + int(threadIdx.x), m = int(blockIdx.y);
    if (s >= pixels || strand[s] < 0) return;
    const auto at = [&](int channel) -> float& { return dynamic[size_t(channel) * pixels + s]; };
    float motion[numbers - modes] = {};
    if (m >= modes) {
        const Quatf to_root = conjugate(turn[s]);
        const Vec3f x = root[s];
        const float per_gravity = 1 / standard_gravity;
        const Vec3f g = per_gravity * rotate(to_root, head->gravity),
                    w = swing[s] * rotate(to_root, head->turning),
                    a = per_gravity * rotate(to_root, head->pull + x.x * head->pull_x[0] +
                                                          x.y * head->pull_x[1] + x.z * head->pull_x[2]);
        if (m == numbers) {
            at(gravity) = g.x, at(gravity + 1) = g.y, at(gravity + 2) = g.z;
            at(turning) = w.x, at(turning + 1) = w.y, at(turning + 2) = w.z;
            at(pull) = a.x, at(pull + 1) = a.y, at(pull + 2) = a.z;
            return;
        }
        motion[past_turning] = w.x, motion[past_turning + 1] = w.y, motion[past_turning + 2] = w.z;
        motion[past_pull] = a.x, motion[past_pull + 1] = a.y, motion[past_pull + 2] = a.z;
    }
    // A ring of the last frames: `slot` holds this one.
    auto then = [&](int slot) -> float& { return past[(size_t(slot) * numbers + m) * pixels + s]; };
    const float now = m < modes ? at(base + history_amplitude(m)) : motion[m - modes];
    for (int k = 0; head->first && k < lags.slots; ++k) then(k) = now;
    then(head->slot) = now;
    float before[lags.count];
    for (int l = 0; l < lags.count; ++l)
        before[l] = then((head->slot + lags.slots - lags.frames[l]) % lags.slots);
    for (int l = 0; l < lags.count; ++l)
        at(history + l * numbers + m) = m < modes ? now - before[l] : before[l];
}

// What strands are kept out of, and where each may lie in it.
struct Outside {
    const ShapeView* shapes;
    int count;
    const float* depth;   // (particle, pixel)
    unsigned char* torn;  // (pixel)

    // x in the head's frame.
    __device__ Vec3f pushed(Vec3f x, float allowed) const {
        for (int h = 0; h < count; ++h) x = pushed_out(shapes[h], x, allowed);
        return x;
    }
};

constexpr int axes = 3, place_rows = axes * tile_rows, of_four = 4;
// A round that leads edges needs the particles beside; the one before a block's own is told with them.
constexpr int held_before = most_length_rounds + 1, held_after = most_length_rounds,
              held = tile + held_before + held_after, turns = (held + place_rows - 1) / place_rows;

// A thread: four amplitudes of a strand, of `frames` frames in a ring.
__global__ void average_kernel(const HeadState* head, int count, int frames,
                               const float4* __restrict__ answer, float4* __restrict__ ring,
                               float4* __restrict__ mean) {
    constexpr int amplitudes = strand_coefficients / of_four, outputs = strand_outputs / of_four;
    const int k = int(blockIdx.x * blockDim.x + threadIdx.x);
    if (k >= count) return;
    const int at = k / amplitudes * outputs + k % amplitudes, slot = head->slot % frames;
    const float4 now = answer[at];
    float4 sum = now;  // the oldest last, wherever in the ring it lies
    ring[size_t(slot) * count + k] = now;
    for (int back = 1; back < frames; ++back) {
        float4* const kept = ring + size_t((slot + frames - back) % frames) * count + k;
        if (head->first) *kept = now;
        const float4 then = *kept;
        sum.x += then.x, sum.y += then.y, sum.z += then.z, sum.w += then.w;
    }
    const float share = 1 / float(frames);
    mean[at] = {share * sum.x, share * sum.y, share * sum.z, share * sum.w};
}

// A block: `tile` strands of a row of the grid by up to `tile` particles, turned over in shared memory so
// that both sides are read and written in order. `offsets` (n, 24): of unit amplitudes. `lengths` (n, S).
__global__ void __launch_bounds__(tile* place_rows)
    place_kernel(const HeadState* head, int pixels, int n, int particles, const int* __restrict__ strand,
                 const Quatf* __restrict__ turn, const Vec3f* __restrict__ root,
                 const float* __restrict__ base, const float* __restrict__ offsets,
                 const float* __restrict__ answer, const float* __restrict__ strand_lengths,
                 const float* __restrict__ lengths, int rounds, const Outside outside,
                 Vec3f* __restrict__ out) {
    static_assert(axes * held % 2 == 1, "strands lie in different banks");
    __shared__ float near[tile][axes * held];
    __shared__ float depths[held][tile], edges[held][tile];
    __shared__ float4 rise[held][dct_kept / of_four];
    __shared__ float4 amplitudes[tile][strand_coefficients / of_four + 1];  // strands lie in different banks
    const int first = int(blockIdx.x) * tile, column = int(threadIdx.x), s = first + column,
              row = int(threadIdx.y), thread = row * tile + column, begin = int(blockIdx.y) * particles,
              end = min(begin + particles, n), before = max(begin - held_before, 0),
              count = min(end + held_after, n) - before;
    // All of it is asked for at once.
    const int own = min(s, pixels - 1), mine = s < pixels ? strand[own] : -1;
    const Quatf to_head = turn[own];
    const Vec3f from = root[own];
    const float in_metres = strand_lengths[own];
    static_assert(strand_outputs % of_four == 0, "answers are read by fours");
    constexpr int whole = strand_coefficients / of_four, all = tile * place_rows;
    for (int k = thread; k < min(tile, pixels - first) * whole; k += all) {
        float4* const to = &amplitudes[k / whole][k % whole];
        if (answer)
            __pipeline_memcpy_async(
                to, answer + size_t(first + k / whole) * strand_outputs + of_four * (k % whole),
                sizeof(float4));
        else
            *to = {0, 0, 0, 0};
    }
    for (int k = thread; k < count * (dct_kept / of_four); k += all)
        __pipeline_memcpy_async(&rise[0][0] + k, offsets + before * dct_kept + of_four * k, sizeof(float4));
    const int axis = row % axes;
    if (s < pixels) {
        const float* of_axis = base + (size_t(axis) * n + before) * pixels + s;
        for (int i = row / axes; i < count; i += tile_rows)
            __pipeline_memcpy_async(&near[column][axes * i + axis], of_axis + size_t(i) * pixels,
                                    sizeof(float));
        for (int i = row; i < count; i += place_rows) {
            const size_t at = size_t(before + i) * pixels + s;
            __pipeline_memcpy_async(&edges[i][column], lengths + at, sizeof(float));
            if (outside.count > 0)
                __pipeline_memcpy_async(&depths[i][column], outside.depth + at, sizeof(float));
        }
    }
    __pipeline_commit();
    __pipeline_wait_prior(0);
    __syncthreads();
    const bool there = mine >= 0;
    if (there) {  // offsets, an axis a thread
        float4 amplitude[dct_kept / of_four];
#pragma unroll
        for (int m = 0; m < dct_kept / of_four; ++m)
            amplitude[m] = amplitudes[column][axis * (dct_kept / of_four) + m];
#pragma unroll 2
        for (int i = row / axes; i < count; i += tile_rows) {
            float offset = 0;
#pragma unroll
            for (int m = 0; m < dct_kept / of_four; ++m) {
                const float4 r = rise[i][m], a = amplitude[m];
                offset += r.x * a.x, offset += r.y * a.y, offset += r.z * a.z, offset += r.w * a.w;
            }
            near[column][axes * i + axis] += in_metres * offset;
        }
    }
    __syncthreads();
    const auto offset_of = [&](int i) {
        const float* p = &near[column][axes * i];
        return Vec3f{p[0], p[1], p[2]};
    };
    const auto put = [&](int i, const Vec3f& v) {
        float* p = &near[column][axes * i];
        p[0] = v.x, p[1] = v.y, p[2] = v.z;
    };
    // Edges: a thread has some particles one after the other, and meets those beside in `near`.
    const int own_first = row * turns, own_count = there ? min(turns, count - own_first) : 0;
    Vec3f x[turns + 1];
    float length[turns + 1];
#pragma unroll
    for (int k = 0; k <= turns; ++k) {
        length[k] = own_first + k < count ? edges[own_first + k][column] : 0;
        if (k < own_count) x[k] = offset_of(own_first + k);
    }
    for (int round = 0; round < rounds; ++round) {
        Vec3f lacking{0, 0, 0};
        if (own_first + turns < count) x[turns] = offset_of(own_first + turns);
        if (own_count > 0 && own_first > 0)
            lacking = half_lacking(x[0] - offset_of(own_first - 1), length[0]);
#pragma unroll
        for (int k = 0; k < turns; ++k) {
            if (k >= own_count) continue;
            Vec3f after{0, 0, 0};
            if (own_first + k + 1 < count) after = half_lacking(x[k + 1] - x[k], length[k + 1]);
            if (own_first + k > 0) x[k] += lacking - after;
            lacking = after;
        }
        __syncthreads();
#pragma unroll
        for (int k = 0; k < turns; k += turns - 1)
            if (k < own_count) put(own_first + k, x[k]);
        __syncthreads();
    }
#pragma unroll
    for (int k = 0; k < turns; ++k) {  // positions
        if (k >= own_count) continue;
        const int i = own_first + k;
        Vec3f at = from + rotate(to_head, x[k]);
        if (outside.count > 0 && before + i > 0) at = outside.pushed(at, depths[i][column]);
        put(i, head->translation + rotate(head->rotation, at));
    }
    __syncthreads();
    for (int i = max(begin, 1) - before + row; outside.count > 0 && there && i < end - before;
         i += place_rows)
        if (is_torn(offset_of(i) - offset_of(i - 1), torn_lengths * edges[i][column])) outside.torn[s] = 1;
    for (int k = row; k < tile; k += place_rows) {
        const int to = __shfl_sync(~0u, mine, k);
        if (to < 0) continue;
        float* p = &out[size_t(to) * n + begin].x;
        for (int l = column; l < axes * (end - begin); l += tile) p[l] = near[k][axes * (begin - before) + l];
    }
}

// Torn strands, a warp each; all its lanes go along the strand, whose next 32 particles they hold.
__global__ void lead_kernel(const HeadState* head, int pixels, int n, const int* __restrict__ strand,
                            const float* __restrict__ lengths, const Outside outside, Vec3f* out) {
    const int s = int(blockIdx.x) * threads + int(threadIdx.x), lane = int(threadIdx.x) % tile;
    constexpr unsigned all = ~0u;
    const bool torn = s < pixels && outside.torn[s];
    if (torn) outside.torn[s] = 0;
    const Quatf back = conjugate(head->rotation);
    for (unsigned left = __ballot_sync(all, torn); left; left &= left - 1) {
        const int pixel = s - lane + __ffs(int(left)) - 1;
        Vec3f* const x = out + size_t(strand[pixel]) * n;
        Vec3f before{0, 0, 0};
        for (int begin = 0; begin < n; begin += tile) {
            const int mine = min(begin + lane, n - 1);
            Vec3f own = x[mine];
            const float depth = outside.depth[size_t(mine) * pixels + pixel],
                        edge = lengths[size_t(mine) * pixels + pixel];
            for (int k = 0; k < tile && begin + k < n; ++k) {
                Vec3f p{__shfl_sync(all, own.x, k), __shfl_sync(all, own.y, k), __shfl_sync(all, own.z, k)};
                const float allowed = __shfl_sync(all, depth, k), length = __shfl_sync(all, edge, k);
                if (begin + k > 0)
                    p = led_around(before, p, torn_lengths * length, [&](const Vec3f& world) {
                        const Vec3f from = rotate(back, world - head->translation),
                                    to = outside.pushed(from, allowed);
                        return norm(to - from) > 0 ? head->translation + rotate(head->rotation, to) : world;
                    });
                if (lane == k) own = p;
                before = p;
            }
            if (begin + lane < n) x[mine] = own;
        }
    }
}

}  // namespace

StrandKernels::StrandKernels(const StrandCodec& codec, const Groom& low)
    : n_(codec.particles()),
      low_(low.rest.count),
      high_(codec.roots().count()),
      pixels_(int(codec.pixels())),
      width_(codec.carrier().around().width),
      lags_(codec.lags()),
      slots_(codec.slots()),
      averaged_(codec.averaged()),
      answers_(size_t(averaged_) * pixels_ * strand_coefficients / of_four),
      mean_(std::vector<float4>(size_t(pixels_) * strand_outputs / of_four, float4{0, 0, 0, 0})) {
    const size_t n = size_t(n_), S = size_t(pixels_), width = size_t(width_);
    head() = {};
    const RestCarrier& carrier = codec.carrier();
    // (low, n) to (n, low).
    auto by_particles = [&](const std::vector<Vec3f>& of_strands) {
        std::vector<float4> out(of_strands.size());
        for (size_t k = 0; k < of_strands.size(); ++k) {
            const Vec3f& v = of_strands[k];
            out[k % n * size_t(low_) + k / n] = {v.x, v.y, v.z, 0};
        }
        return out;
    };
    std::vector<Vec3f> low_rest(low.rest.points);
    for (int s = 0; s < low_; ++s)
        for (int i = n_ - 1; i >= 0; --i) low_rest[size_t(s) * n + i] = low.rest.at(s, i) - low.rest.at(s, 0);
    if (carrier.low_is_wet()) low_rest_ = DeviceBuffer<float4>(by_particles(low_rest));
    const Settled& settled = carrier.settled();
    for (size_t k = 0; k < settled.more.points.size(); ++k) low_rest[k] -= settled.more.points[k];
    share_ = DeviceBuffer<float>(settled.share.empty() ? std::vector<float>(size_t(low_), 1) : settled.share);
    low_start_ = DeviceBuffer<Vec3f>(low_rest);

    const Stencil& around = carrier.around();
    std::vector<float> weight(width * S, 0), lost_weight(width * S, 0);
    std::vector<int> from(width * S, 0), strand(S, -1);
    std::vector<Quatf> turn(S, Quatf::identity());
    std::vector<Vec3f> root(S, Vec3f{0, 0, 0});
    for (size_t s = 0; s < size_t(high_); ++s) {
        const size_t pixel = size_t(codec.pixel_of()[s]);
        strand[pixel] = int(s), turn[pixel] = codec.roots().rotation[s], root[pixel] = codec.roots().root[s];
        for (size_t k = 0; k < width; ++k) {
            from[k * S + pixel] = around.from[s * width + k];
            weight[k * S + pixel] = around.weight[s * width + k];
            lost_weight[k * S + pixel] = carrier.lost_weight()[s * width + k];
        }
    }
    take_rest(codec);
    length_ = by_pixels(codec.edges(), strand);
    if (carrier.low_is_wet()) {
        std::vector<int> kept(S, -1);
        for (int s = 0; s < low_; ++s)
            if (const int twin = around.twin[size_t(s)]; twin >= 0)
                kept[size_t(codec.pixel_of()[size_t(twin)])] = s;
        kept_ = DeviceBuffer<int>(kept);
    }
    weight_ = DeviceBuffer<float>(weight);
    per_low_length_ = DeviceBuffer<float>(carrier.per_low_length());
    lost_weight_ = DeviceBuffer<float>(lost_weight), beside_ = DeviceBuffer<Beside>(carrier.beside());
    own_ = DeviceBuffer<float4>(by_particles(carrier.own().points)),
    lost_ = DeviceBuffer<float>(size_t(low_));
    from_ = DeviceBuffer<int>(from), strand_ = DeviceBuffer<int>(strand);
    turn_ = DeviceBuffer<Quatf>(turn), root_ = DeviceBuffer<Vec3f>(root);
    std::vector<float> per_length(S, 0), swing(S, 0);
    for (size_t s = 0; s < size_t(high_); ++s) {
        const size_t pixel = size_t(codec.pixel_of()[s]);
        per_length[pixel] = codec.per_length(int(s)), swing[pixel] = codec.swing(int(s));
    }
    strand_length_ = DeviceBuffer<float>(codec.length()), per_length_ = DeviceBuffer<float>(per_length);
    swing_ = DeviceBuffer<float>(swing);
    past_ = DeviceBuffer<float>(size_t(codec.slots()) * past_layout.count * S);

    // What unit strands give, by particle.
    std::vector<float> amplitudes(n * dct_kept, 0), offsets(n * dct_kept, 0);
    for (size_t j = 0; j < n; ++j) {
        std::vector<Vec3f> unit(n, Vec3f{0, 0, 0});
        unit[j].x = 1;
        float c[strand_coefficients];
        codec.dct().encode(unit.data(), c);
        std::copy_n(c, dct_kept, amplitudes.begin() + long(j * dct_kept));
    }
    for (size_t k = 0; k < dct_kept; ++k) {
        std::vector<Vec3f> rise(n);
        float c[strand_coefficients] = {};
        c[k] = 1;
        codec.dct().decode(c, rise.data());
        for (size_t i = 0; i < n; ++i) offsets[i * dct_kept + k] = rise[i].x;
    }
    amplitudes_ = DeviceBuffer<float>(amplitudes), offsets_ = DeviceBuffer<float>(offsets);
    departed_ = DeviceBuffer<float4>(n * size_t(low_)), moved_ = DeviceBuffer<float4>(n * size_t(low_));
    base_ = DeviceBuffer<float>(std::vector<float>(3 * n * S, 0));
    std::vector<float> image(size_t(strand_channels) * S, 0);
    std::copy(codec.fixed().begin(), codec.fixed().end(), image.begin());
    image_ = DeviceBuffer<float>(image);
}

void StrandKernels::take_rest(const StrandCodec& codec) {
    const size_t n = size_t(n_), S = size_t(pixels_);
    std::vector<RestUnits> units(S);
    std::vector<RestEdge> edges(n * S);
    std::vector<RestDetail> details(n * S);
    std::vector<RestParticle<float>> strand(n);
    auto unit_of = [&](Vec3f RestParticle<float>::*part) {
        float most = 0;
        for (const auto& p : strand)
            most = std::max({most, std::abs((p.*part).x), std::abs((p.*part).y), std::abs((p.*part).z)});
        return most / float(std::numeric_limits<int16_t>::max());
    };
    auto put = [](const Vec3f& v, float unit, int16_t& x, int16_t& y, int16_t& z) {
        auto in_units = [&](float at) { return int16_t(unit > 0 ? std::lround(at / unit) : 0); };
        x = in_units(v.x), y = in_units(v.y), z = in_units(v.z);
    };
    for (size_t s = 0; s < size_t(high_); ++s) {
        for (size_t i = 0; i < n; ++i) {
            RestParticle<float>& p = strand[i] = codec.carrier().rest(int(s), int(i));
            p.curled = p.length * normalized(p.curled, normalized(p.edge, {1, 0, 0}));
        }
        const size_t pixel = size_t(codec.pixel_of()[s]);
        const RestUnits& unit =
            units[pixel] = {unit_of(&RestParticle<float>::edge), unit_of(&RestParticle<float>::curled),
                            unit_of(&RestParticle<float>::detail), unit_of(&RestParticle<float>::own)};
        for (size_t i = 0; i < n; ++i) {
            const RestParticle<float>& p = strand[i];
            RestEdge& e = edges[i * S + pixel];
            RestDetail& d = details[i * S + pixel];
            put(p.edge, unit.edge, e.edge[0], e.edge[1], e.edge[2]);
            put(p.curled, unit.curled, e.curled[0], e.curled[1], e.curled[2]);
            put(p.detail, unit.detail, d.detail[0], d.detail[1], d.detail[2]);
            put(p.own, unit.own, e.own_xy[0], e.own_xy[1], d.own_z);
        }
    }
    units_ = DeviceBuffer<RestUnits>(units);
    edges_ = DeviceBuffer<RestEdge>(edges), details_ = DeviceBuffer<RestDetail>(details);
}

DeviceBuffer<float> StrandKernels::by_pixels(const std::vector<float>& of_particles,
                                             const std::vector<int>& strand) const {
    std::vector<float> out(size_t(n_) * pixels_, 0);
    for (int i = 0; i < n_; ++i)
        for (int s = 0; s < pixels_; ++s)
            if (strand[size_t(s)] >= 0)
                out[size_t(i) * pixels_ + s] = of_particles[size_t(strand[size_t(s)]) * n_ + i];
    return DeviceBuffer<float>(out);
}

void StrandKernels::keep_outside(const HeadShapes& head) {
    require_each(head, size_t(high_) * n_);
    grids_.clear();
    std::vector<ShapeView> shapes;
    for (const Shape& shape : head.shapes) {
        ShapeView& view = shapes.emplace_back(view_of(shape));
        if (view.kind != ShapeView::Kind::grid) continue;
        DistanceGrid& grid = view.grid;
        const size_t nodes = size_t(grid.nx) * grid.ny * grid.nz;
        grids_.emplace_back(std::vector<float>(grid.phi, grid.phi + nodes));
        grid.phi = grids_.back().data();
    }
    shapes_ = DeviceBuffer<ShapeView>(shapes);
    std::vector<int> strand(size_t(pixels_), -1);
    strand_.download(strand.data());
    depth_ = by_pixels(head.depth, strand);
    torn_ = DeviceBuffer<unsigned char>(std::vector<unsigned char>(size_t(pixels_), 0));
}

void StrandKernels::begin_frame(const HeadWindow& heads, bool first) {
    const int slot = (head().slot + 1) % slots_;
    head() = HeadState(heads, first);
    head().slot = slot;
}

void StrandKernels::take_head(cudaStream_t stream) const {
    check_cuda(
        cudaMemcpyAsync(head_.data(), head_host_.data(), sizeof(HeadState), cudaMemcpyHostToDevice, stream),
        "the head's motion");
}

void StrandKernels::depart(const Vec3f* low, cudaStream_t stream) const {
    depart_kernel<<<dim3(blocks_of(low_, tile), blocks_of(n_, tile)), dim3(tile, tile_rows), 0, stream>>>(
        head_.data(), low, share_.data(), low_start_.data(), low_, n_, departed_.data());
    check_launch("departure from rest");
}

void StrandKernels::move_cores(cudaStream_t stream) const {
    constexpr int axes_and_none = 4;
    const int columns = axes_and_none * low_;
    core_kernel<<<blocks_of(columns), threads, 0, stream>>>(columns, n_, core_beta(n_), &departed_.data()->x,
                                                            &moved_.data()->x);
    check_launch("cores");
}

void StrandKernels::carry(cudaStream_t stream) const {
    lost_kernel<<<blocks_of(low_, lost_strands), dim3(lost_strands, lost_parts), 0, stream>>>(
        low_, n_, beside_.data(), per_low_length_.data(), own_.data(), moved_.data(), lost_.data());
    check_launch("what strands lose of their own");
    carry_kernel<<<blocks_of(pixels_, carriers), carriers, 0, stream>>>(
        pixels_, low_, n_, width_, strand_.data(), units_.data(), edges_.data(), details_.data(),
        from_.data(), weight_.data(), lost_weight_.data(), lost_.data(), turn_.data(), per_length_.data(),
        per_low_length_.data(), moved_.data(), Kept{kept_.data(), low_rest_.data(), departed_.data()},
        reinterpret_cast<const float4*>(amplitudes_.data()), base_.data(), dynamic());
    check_launch("rest shapes carried");
}

void StrandKernels::describe(cudaStream_t stream) const {
    Lags lags{{}, slots_};
    std::copy(lags_.begin(), lags_.end(), lags.frames);
    describe_kernel<<<dim3(blocks_of(pixels_), past_layout.count + 1), threads, 0, stream>>>(
        head_.data(), pixels_, strand_.data(), turn_.data(), root_.data(), swing_.data(), lags, past_.data(),
        dynamic());
    check_launch("features of motion");
}

const float* StrandKernels::average(const float* answer, cudaStream_t stream) const {
    const int count = pixels_ * (strand_coefficients / of_four);
    average_kernel<<<blocks_of(count), threads, 0, stream>>>(head_.data(), count, averaged_,
                                                             reinterpret_cast<const float4*>(answer),
                                                             answers_.data(), mean_.data());
    check_launch("mean of answers");
    return &mean_.data()->x;
}

void StrandKernels::place(const float* answer, int rounds, Vec3f* out, cudaStream_t stream,
                          bool within_shapes) const {
    const Outside outside{shapes_.data(), within_shapes ? 0 : int(shapes_.size()), depth_.data(),
                          torn_.data()};
    const unsigned parts = blocks_of(n_, tile);  // of a strand
    place_kernel<<<dim3(blocks_of(pixels_, tile), parts), dim3(tile, place_rows), 0, stream>>>(
        head_.data(), pixels_, n_, int(blocks_of(n_, int(parts))), strand_.data(), turn_.data(), root_.data(),
        base_.data(), offsets_.data(), answer, strand_length_.data(), length_.data(), rounds, outside, out);
    check_launch("placement in the world");
    if (outside.count == 0) return;
    lead_kernel<<<blocks_of(pixels_), threads, 0, stream>>>(head_.data(), pixels_, n_, strand_.data(),
                                                            length_.data(), outside, out);
    check_launch("strands led around the head");
}

}  // namespace wetcurl
