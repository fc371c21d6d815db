// Kernels of the displayed positions: neighbours in the order of cells, smoothing strand by strand.
#include <algorithm>
#include <string>

#include "cuda/cohesion/cohesion_kernel.h"
#include "cuda/cohesion/cohesion_lists.h"
#include "cuda/device/cuda_owners.h"

namespace wetcurl {

namespace {

constexpr int warp = 32;

unsigned blocks_for(size_t items, int threads) {
    return unsigned((items + size_t(threads) - 1) / size_t(threads));
}

constexpr int most_strands = 4;  // of a block whose warps take a strand each

// The strand of this warp; at least `strands` where there is none.
__device__ int strand_of_warp() { return int((blockIdx.x * blockDim.x + threadIdx.x) / warp); }

// Of a line through p(0), ..., p(n - 1), by a warp.
template <class P>
__device__ float length_of(int n, P p) {
    float length = 0;
    for (int i = int(threadIdx.x) % warp; i + 1 < n; i += warp) length += norm(p(i + 1) - p(i));
    for (int other = 1; other < warp; other *= 2) length += __shfl_xor_sync(0xffffffffu, length, other);
    return length;
}

// `asked` becomes where those are of whom Eq 10 is asked; null: all are.
__global__ void __launch_bounds__(most_strands* warp)
    measure(const CohesionKernelBody b, int strands, const Vec3f* positions, Vec3f* asked) {
    const int strand = strand_of_warp(), n = b.thinning.particles, count = b.m.search.particles;
    if (strand >= strands) return;
    const Vec3f* const x = positions + size_t(strand) * size_t(n);
    const float length = length_of(n, [&](int i) { return x[i]; });
    float between = length;
    if (asked) {
        auto at = [&](int j) { return x[b.thinning.at(strand, j)]; };
        for (int j = int(threadIdx.x) % warp; j < count; j += warp)
            asked[size_t(strand) * size_t(count) + size_t(j)] = at(j);
        between = length_of(count, at);
    }
    if (threadIdx.x % warp == 0) b.measure(strand, length, between);
}

constexpr int short_list = 8, most_staged = 48;  // neighbours
constexpr int threads_a_block = 128;

// Before the lists where some hair is dry: then they ask who is wet.
__global__ void __launch_bounds__(threads_a_block)
    take(const CohesionKernelBody b, const float* volume, const float* wet_volume) {
    const uint32_t k = blockIdx.x * threads_a_block + threadIdx.x;
    if (k < b.m.search.count) b.take(k, volume, wet_volume);
}

// A block of lists each. They lie where it finds room, which differs from run to run; whom they name, and in
// which order, does not.
__global__ void __launch_bounds__(list_block)
    build_lists(const CohesionKernelBody b, const float* volume, const float* wet_volume, size_t room,
                int staged, FrameReport* report) {
    __shared__ ListRoom own;
    extern __shared__ uint32_t near[];
    const uint32_t k = blockIdx.x * list_block + threadIdx.x;
    if (!b.m.wet_cell && k < b.m.search.count) b.take(k, volume, wet_volume);
    const ThreadTeam<Block> team{Block{}, int(threadIdx.x), list_block};
    CohesionLists(b, team, blockIdx.x, near, staged).build(own, [&](uint32_t rows, unsigned pairs) {
        const unsigned long long row = atomicAdd(&report->list_rows, static_cast<unsigned long long>(rows));
        atomicAdd(&report->pairs, static_cast<unsigned long long>(pairs));
        return row + rows <= room ? uint32_t(row) : no_list;  // else the frame is done again
    });
}

constexpr int pass_threads = 256;
constexpr int threads_of_few = 4;  // that sum up a list where lists leave a device's threads without work

// Half of a Jacobi pass, in the order of cells, so many threads a particle.
template <int shared>
__global__ void __launch_bounds__(pass_threads) displace(const CohesionKernelBody b, uint32_t places) {
    const uint32_t thread = blockIdx.x * pass_threads + threadIdx.x, place = thread / shared;
    const unsigned mates = ((1u << shared) - 1) << (threadIdx.x % warp / shared * shared);
    if (place >= places) return;
    b.displace<shared>(place, int(thread % shared), [&](float x) {
        for (int other = 1; other < shared; other *= 2) x += __shfl_xor_sync(mates, x, other);
        return x;
    });
}

// The other, whole strands a block. Shared memory: as MoveWorkspace says.
using MoveWorkspace = CohesionKernelBody::MoveWorkspace;
size_t bytes_to_move(int strands, int particles, bool keeps) {
    return size_t(strands) * (3 * sizeof(float) * size_t(MoveWorkspace::numbers_a_strand(particles)) +
                              (keeps ? (sizeof(HairPoint) + sizeof(uint32_t)) * size_t(particles) : 0));
}
__global__ void __launch_bounds__(pass_threads)
    move_strands(const CohesionKernelBody b, int strands_of_block, bool keeps) {
    extern __shared__ __align__(16) unsigned char own[];
    const int n = b.m.search.particles, first = int(blockIdx.x) * strands_of_block,
              strands = min(strands_of_block, int(b.m.search.count) / n - first),
              kept = keeps ? strands * n : 0;
    HairPoint* const from = reinterpret_cast<HairPoint*>(own);
    uint32_t* const rank = reinterpret_cast<uint32_t*>(from + kept);
    const MoveWorkspace workspace{reinterpret_cast<float*>(rank + kept), keeps ? from : nullptr, rank};
    b.move_strands(ThreadTeam<Block>{Block{}, int(threadIdx.x), int(blockDim.x)}, first, strands, workspace);
}

constexpr int show_threads = 5 * warp, most_shown = 16;  // of a block, strands at most
// A lane's particles of a strand: what they need is on its way together. The last comes again for those
// beyond it.
struct Batch {
    static constexpr int size = 2;
    int first, n, at[size];
    __device__ Batch(int first, int n) : first(first), n(n) {
#pragma unroll
        for (int k = 0; k < size; ++k) at[k] = min(first + k * warp, n - 1);
    }
    // f(particle, k), but for those.
    template <class F>
    __device__ void each(F f) const {
#pragma unroll
        for (int k = 0; k < size; ++k)
            if (first + k * warp < n) f(at[k], k);
    }
};

// Whole strands a block: particles by all its threads, what goes along a strand by one. Shared memory:
// (strand, row_of(particles)) and, where not all are asked, (strand, particle that is).
__host__ __device__ int row_of(int particles) { return particles | 1; }  // strands lie in different banks
size_t bytes_to_show(const Thinning& thinning) {
    return size_t(row_of(thinning.particles)) * sizeof(ShownPoint) +
           (thinning.every > 1 ? size_t(thinning.count) * sizeof(Vec3f) : 0);
}
template <class T>
__global__ void __launch_bounds__(show_threads, 7)
    show(const CohesionKernelBody b, int strands, int strands_of_block, const Vec3f* simulated,
         const float* rest_depth, const SubstepMotion<T>* motion, Vec3f* displayed) {
    extern __shared__ ShownPoint shown[];
    const int n = b.thinning.particles, asked = b.m.search.particles,
              first = int(blockIdx.x) * strands_of_block, count = min(strands_of_block, strands - first),
              thread = int(threadIdx.x);
    auto strand = [&](int s) { return shown + s * row_of(n); };
    Vec3f* const moved = reinterpret_cast<Vec3f*>(strand(strands_of_block));
    auto allowed = [&](int s, int i) {
        return rest_depth ? rest_depth[size_t(first + s) * size_t(n) + size_t(i)] : 0.f;
    };
    // f(strand, batch) for batches of its particles from `begin` on.
    auto for_each_batch = [&](int begin, auto f) {
        for (int s = thread / warp; s < count; s += show_threads / warp)
            for (int i = begin + thread % warp; i - thread % warp < n; i += Batch::size * warp)
                f(s, Batch(i, n));
        __syncthreads();
    };
    if (b.thinning.every > 1)
        ThreadTeam<Block>(Block{}, thread, show_threads).share(count, asked, [&](int s, int j) {
            moved[s * asked + j] = b.moved(first + s, j, simulated);
        });
    for_each_batch(0, [&](int s, const Batch& batch) {
        ShownPoint x[Batch::size];
#pragma unroll
        for (int k = 0; k < Batch::size; ++k)
            x[k] = b.shown(first + s, batch.at[k], simulated, moved + s * asked);
        batch.each([&](int i, int k) { strand(s)[i] = x[k]; });
    });
    if (thread < count) b.within_lengths(strand(thread));
    __syncthreads();
    for_each_batch(1, [&](int s, const Batch& batch) {
        Vec3f x[Batch::size];
        float deep[Batch::size];
#pragma unroll
        for (int k = 0; k < Batch::size; ++k)
            x[k] = strand(s)[batch.at[k]].position(), deep[k] = allowed(s, batch.at[k]);
        push_out(*motion, x, deep);
        __syncwarp();  // the last may be another lane's
        batch.each([&](int i, int k) { strand(s)[i].put(x[k]); });
    });
    bool torn = false;
    for_each_batch(1, [&](int s, const Batch& batch) {
        batch.each([&](int i, int) {
            const ShownPoint* x = strand(s) + i;
            torn |= is_torn(x->position() - x[-1].position(), b.term.torn_beyond(x->length));
        });
    });
    if (__syncthreads_or(torn)) {
        ShownPoint* const x = strand(thread);
        for (int i = 1; thread < count && i < n; ++i)
            x[i].put(led_around(x[i - 1].position(), x[i].position(), b.term.torn_beyond(x[i].length),
                                [&](const Vec3f& p) { return pushed_out(*motion, p, allowed(thread, i)); }));
        __syncthreads();
    }
    for (int s = thread / warp; s < count; s += show_threads / warp) {
        float* const to = &displayed[size_t(first + s) * size_t(n)].x;
        for (int k = thread % warp; k < 3 * n; k += warp) to[k] = (&strand(s)[k / 3].x)[k % 3];
    }
}

std::vector<float> wet_volumes_of(const std::vector<float>& volume, const std::vector<float>& saturation) {
    std::vector<float> wet;
    for (size_t k = 0; k < volume.size(); ++k) wet.push_back(volume[k] * saturation[k]);
    return wet;
}

}  // namespace

CohesionDevice::CohesionDevice(const Cohesion& term, int strands, const Thinning& thinning,
                               const Vec3f& origin, const std::vector<float>& volume,
                               const std::vector<float>& saturation, bool flows,
                               const std::vector<float>& rest_depth)
    : term_(term),
      thinning_(thinning),
      strands_(strands),
      search_(size_t(strands) * size_t(thinning.count), thinning.count, term.h_c, origin),
      rest_depth_(rest_depth),
      who_(blocks_for(search_.view().count, list_block) * size_t(list_block)),
      group_(who_.size() / ListGroup::lanes),
      displaced_(search_.view().count),
      beta_(size_t(strands)),
      own_weight_(size_t(strands)),
      self_weight_(search_.view().count) {
    const int particles = thinning.count;
    if (!thinning.is_whole()) {
        const ThinnedWater water(thinning, volume, saturation);
        volume_ = DeviceBuffer<float>(water.volume);
        wet_volume_ = DeviceBuffer<float>(wet_volumes_of(water.volume, water.saturation));
        own_volume_ = DeviceBuffer<float>(water.own_volume);
        if (thinning.every > 1) thinned_ = DeviceBuffer<Vec3f>(volume_.size());
    } else {
        volume_ = DeviceBuffer<float>(volume);
        wet_volume_ = DeviceBuffer<float>(wet_volumes_of(volume, saturation));
    }
    point_ = DeviceBuffer<HairPoint>(volume_.size() + 1);
    sorted_wet_volume_ = DeviceBuffer<float>(volume_.size() + 1);
    if (flows || thinning.seen < 1 || std::ranges::any_of(saturation, [](float sigma) { return sigma <= 0; }))
        wet_cell_ = DeviceBuffer<uint8_t>(search_.view().grid.cells());
    int device = 0, processors = 1, most_shared = 0;
    check_cuda(cudaGetDevice(&device), "device");
    check_cuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device), "attribute");
    check_cuda(cudaDeviceGetAttribute(&most_shared, cudaDevAttrMaxSharedMemoryPerBlockOptin, device),
               "attribute");
    // A processor holds 2048 threads; twice as many still leave none of it to wait for the longest lists.
    threads_a_list_ = who_.size() * threads_of_few <= size_t(processors) * 2 * 2048 ? threads_of_few : 1;
    staged_ = most_staged;
    const size_t strand_bytes = bytes_to_show(thinning);
    if (strand_bytes > size_t(most_shared))
        throw Error("cohesion on a CUDA device: found strands of " + std::to_string(thinning.particles) +
                    " particles, allowed at most about " +
                    std::to_string(size_t(most_shared) * size_t(thinning.particles) / strand_bytes));
    // Eight blocks a processor, four in its memory where they fit; a warp smooths eight strands' coordinates.
    keeps_ = bytes_to_move(1, particles, true) <= size_t(most_shared);
    const size_t of_a_strand = bytes_to_move(1, particles, keeps_);
    strands_of_block_ =
        std::clamp(std::min(strands / (8 * processors), int(size_t(most_shared) / 4 / of_a_strand)), 1, 8);
    blocks_ = unsigned((strands + strands_of_block_ - 1) / strands_of_block_);
    threads_ = std::min((strands_of_block_ * particles + warp - 1) / warp * warp, pass_threads);
    shared_bytes_ = bytes_to_move(strands_of_block_, particles, keeps_);
    shown_of_block_ = std::clamp(
        std::min(strands / (8 * processors), int(size_t(most_shared) / 8 / strand_bytes)), 1, most_shown);
    allow_shared_memory(move_strands), allow_shared_memory(show<float>), allow_shared_memory(show<double>);
    // What a pass reads again shall be near: it shares nothing else.
    for (auto pass : {displace<1>, displace<threads_of_few>})
        check_cuda(cudaFuncSetAttribute(pass, cudaFuncAttributePreferredSharedMemoryCarveout,
                                        cudaSharedmemCarveoutMaxL1),
                   "memory of a processor");
    // Nobody is the last of them.
    check_cuda(cudaMemset(point_.data(), 0, point_.bytes()), "nobody");
    check_cuda(cudaMemset(sorted_wet_volume_.data(), 0, sorted_wet_volume_.bytes()), "nobody");
    check_cuda(cudaMemset(who_.data(), 0, who_.bytes()), "who");  // read where there is no list, too
    check_cuda(cudaStreamSynchronize(nullptr), "nobody");  // streams of launches do not wait for this one
}

CohesionKernelBody CohesionDevice::bodies() const {
    return {term_,
            thinning_,
            {search_.view(), point_.data(), sorted_wet_volume_.data(), wet_cell_.data(), group_.data(),
             who_.data(), list_.data(), displaced_.data(), beta_.data(), own_weight_.data(),
             own_volume_.data(), self_weight_.data()}};
}

void CohesionDevice::launch_lists(const Vec3f* positions, FrameReport* report, cudaStream_t stream) {
    const CohesionKernelBody b = bodies();
    Vec3f* const asked = thinned_.size() ? thinned_.data() : nullptr;
    measure<<<blocks_for(size_t(strands_), most_strands), most_strands * warp, 0, stream>>>(b, strands_,
                                                                                            positions, asked);
    search_.launch(asked ? asked : positions, stream);
    if (wet_cell_.size()) {
        check_cuda(cudaMemsetAsync(wet_cell_.data(), 0, wet_cell_.bytes(), stream), "cells without water");
        take<<<blocks_for(volume_.size(), threads_a_block), threads_a_block, 0, stream>>>(b, volume_.data(),
                                                                                          wet_volume_.data());
    }
    build_lists<<<unsigned(who_.size() / list_block), list_block, ListRoom::near(staged_) * sizeof(uint32_t),
                  stream>>>(b, volume_.data(), wet_volume_.data(), list_.size() / ListGroup::lanes, staged_,
                            report);
    check_cuda(cudaGetLastError(), "launch of the neighbour lists");
}

template <class T>
void CohesionDevice::launch_passes(const Vec3f* simulated, const SubstepMotion<T>* motion, Vec3f* displayed,
                                   cudaStream_t stream) {
    CohesionKernelBody b = bodies();
    const uint32_t places = uint32_t(who_.size());
    const auto displace_by = threads_a_list_ == 1 ? displace<1> : displace<threads_of_few>;
    for (int sweep = 0; sweep < term_.sweeps(); ++sweep) {
        b.term = term_.of_sweep(sweep);
        displace_by<<<blocks_for(places * size_t(threads_a_list_), pass_threads), pass_threads, 0, stream>>>(
            b, places);
        move_strands<<<blocks_, unsigned(threads_), shared_bytes_, stream>>>(b, strands_of_block_, keeps_);
    }
    show<<<blocks_for(size_t(strands_), shown_of_block_), show_threads,
           size_t(shown_of_block_) * bytes_to_show(thinning_), stream>>>(
        b, strands_, shown_of_block_, simulated, rest_depth_.size() ? rest_depth_.data() : nullptr, motion,
        displayed);
    check_cuda(cudaGetLastError(), "launch of the cohesion passes");
}
template void CohesionDevice::launch_passes(const Vec3f*, const SubstepMotion<float>*, Vec3f*, cudaStream_t);
template void CohesionDevice::launch_passes(const Vec3f*, const SubstepMotion<double>*, Vec3f*, cudaStream_t);

bool CohesionDevice::grow(const FrameReport& report) {
    const size_t rows = report.list_rows, row = ListGroup::lanes * sizeof(Ranks<4>);
    if (rows <= list_.size() / ListGroup::lanes) return false;
    list_ = {};
    size_t free = 0, all = 0;
    check_cuda(cudaMemGetInfo(&free, &all), "free memory");
    if (rows * row > free)
        throw Error("cohesion on a CUDA device: lists of neighbours take " +
                    std::to_string(rows * row >> 20) + " MiB, of which " + std::to_string(free >> 20) +
                    " are free; a smaller [cohesion] radius may help");
    // Half as much again, or what there is: hair that falls comes together more and more.
    const size_t ample = std::min(rows + rows / 2, std::max(rows, free / row / 10 * 9));
    list_ = DeviceBuffer<Ranks<4>>(ListGroup::lanes * ample);
    // What lists are staged in is taken from the caches: short ones get little.
    staged_ = report.pairs < short_list * asked() ? 2 * short_list : most_staged;
    return true;
}

size_t CohesionDevice::bytes() const {
    size_t sum = search_.bytes() + point_.bytes() + group_.bytes() + who_.bytes() + list_.bytes() +
                 displaced_.bytes() + wet_cell_.bytes() + thinned_.bytes();
    for (const auto* b : {&volume_, &wet_volume_, &own_volume_, &rest_depth_, &sorted_wet_volume_, &beta_,
                          &own_weight_, &self_weight_})
        sum += b->bytes();
    return sum;
}

}  // namespace wetcurl
