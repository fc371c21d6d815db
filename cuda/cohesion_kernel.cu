// Kernels of the displayed positions: a block takes whole strands, a thread a particle.
#include <algorithm>

#include "cuda/cohesion_kernel.h"
#include "cuda/driver.h"

namespace wetcurl {

namespace {

constexpr int warp = 32;

unsigned blocks_for(size_t items, int threads) {
    return unsigned((items + size_t(threads) - 1) / size_t(threads));
}

__global__ void place(CohesionBodies b, const Vec3f* positions, const float* volume,
                      const float* wet_volume) {
    const uint32_t id = blockIdx.x * blockDim.x + threadIdx.x;
    if (id < b.m.count) b.place(id, positions[id], volume[id], wet_volume[id]);
}
__global__ void measure(CohesionBodies b, int strands) {
    const int strand = int(blockIdx.x * blockDim.x + threadIdx.x);
    if (strand < strands) b.measure(strand);
}

// The particles of a block: `count` from `first` on, and the groups of 32 among them.
struct Share {
    uint32_t first;
    int count, group;
    __device__ Share(const CohesionMemory& m, int strands_of_block, int groups_of_block)
        : first(blockIdx.x * unsigned(strands_of_block) * unsigned(m.particles)),
          count(int(min(m.count - first, unsigned(strands_of_block) * unsigned(m.particles)))),
          group(int(blockIdx.x) * groups_of_block) {}
};

__global__ void __launch_bounds__(1024)
    build_lists(CohesionBodies b, int strands_of_block, int groups_of_block, FrameReport* report) {
    const Share share(b.m, strands_of_block, groups_of_block);
    const int lane = int(threadIdx.x) % warp;
    for (int begin = int(threadIdx.x) - lane; begin < share.count; begin += int(blockDim.x)) {
        const int group = share.group + begin / warp;
        const uint32_t room = b.m.capacity[group];
        uint32_t *list = b.m.list + b.m.offset[group] + lane, found = 0;
        if (begin + lane < share.count)
            b.neighbours(share.first + uint32_t(begin + lane), [&](uint32_t j) {
                if (found < room) list[warp * found] = j;
                ++found;
            });
        const unsigned longest = __reduce_max_sync(0xffffffffu, found),
                       pairs = __reduce_add_sync(0xffffffffu, found);
        for (uint32_t k = found; k < min(longest, room); ++k) list[warp * k] = b.m.count;
        if (lane == 0) {
            b.m.length[group] = longest;
            if (longest > room) atomicOr(&report->overflow, 1u);
            atomicAdd(&report->pairs, static_cast<unsigned long long>(pairs));
        }
    }
}

// One Jacobi pass. Shared memory: displacements (3, count), and 32 numbers a warp.
__global__ void __launch_bounds__(1024) jacobi(CohesionBodies b, int strands_of_block, int groups_of_block,
                                               const HairPoint* now, HairPoint* next) {
    extern __shared__ float u[];
    const Share share(b.m, strands_of_block, groups_of_block);
    const int n = b.m.particles, lane = int(threadIdx.x) % warp;
    for (int k = int(threadIdx.x); k < share.count; k += int(blockDim.x)) {
        const int group = share.group + k / warp;
        const uint32_t id = share.first + uint32_t(k);
        Vec3f d{0, 0, 0};
        if (k % n != 0)
            d = b.displacement(now, id, b.m.list + b.m.offset[group] + lane,
                               min(b.m.length[group], b.m.capacity[group]));
        u[k] = d.x, u[share.count + k] = d.y, u[2 * share.count + k] = d.z;
    }
    if (b.term.coherence > 0) {
        __syncthreads();
        float* ends = u + 3 * share.count + int(threadIdx.x) - lane;
        const int warps = int(blockDim.x) / warp, lines = 3 * (share.count / n);
        // A line is one coordinate of one strand.
        for (int line = int(threadIdx.x) / warp; line < lines; line += warps) {
            const uint32_t strand = share.first / uint32_t(n) + uint32_t(line % (share.count / n));
            smooth_along(u + line / (share.count / n) * share.count + line % (share.count / n) * n, n,
                         b.m.beta[strand], ends, [&](auto body) {
                             body(lane);
                             __syncwarp();
                         });
        }
        __syncthreads();
    }
    for (int k = int(threadIdx.x); k < share.count; k += int(blockDim.x)) {
        HairPoint p = now[share.first + uint32_t(k)];
        p.x += u[k], p.y += u[share.count + k], p.z += u[2 * share.count + k];
        next[share.first + uint32_t(k)] = p;
    }
}

template <class T>
__global__ void show(CohesionBodies b, int strands, const HairPoint* now, const Vec3f* simulated,
                     const float* rest_depth, const SubstepMotion<T>* motion, Vec3f* displayed) {
    const int strand = int(blockIdx.x * blockDim.x + threadIdx.x);
    if (strand >= strands) return;
    const uint32_t root = uint32_t(strand) * uint32_t(b.m.particles);
    b.within_lengths(strand, now, simulated, [&](uint32_t id, const Vec3f& x) {
        displayed[id] = id == root ? x : pushed_out(*motion, x, rest_depth ? rest_depth[id] : 0.f);
    });
}

constexpr int small_block = 128;

}  // namespace

CohesionDevice::CohesionDevice(const Cohesion& term, int strands, int particles, const Vec3f& origin,
                               const std::vector<float>& rest_depth)
    : term_(term),
      strands_(strands),
      particles_(particles),
      volume_(size_t(strands) * size_t(particles)),
      wet_volume_(volume_.size()),
      rest_depth_(rest_depth),
      search_(volume_.size(), particles, term.h_c, origin) {
    const size_t count = volume_.size();
    int device = 0, processors = 1, most_shared = 0;
    check_cuda(cudaGetDevice(&device), "device");
    check_cuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device), "attribute");
    check_cuda(cudaDeviceGetAttribute(&most_shared, cudaDevAttrMaxSharedMemoryPerBlockOptin, device),
               "attribute");
    // Whole strands up to a thousand particles, but at least two blocks a processor.
    strands_of_block_ = std::max(1, std::min(1024 / particles, strands / (2 * processors)));
    blocks_ = unsigned((strands + strands_of_block_ - 1) / strands_of_block_);
    const int items = strands_of_block_ * particles;
    groups_of_block_ = (items + warp - 1) / warp;
    threads_ = std::min(1024, groups_of_block_ * warp);
    shared_bytes_ = sizeof(float) * (3 * size_t(items) + size_t(threads_));
    if (shared_bytes_ > size_t(most_shared))
        throw Error("cohesion on a CUDA device: found strands of " + std::to_string(particles) +
                    " particles, allowed at most " +
                    std::to_string((size_t(most_shared) / sizeof(float) - 1024) / 3));
    allow_shared_memory(jacobi);

    beta_ = DeviceBuffer<float>(size_t(strands)), own_weight_ = DeviceBuffer<float>(size_t(strands));
    const std::vector<HairPoint> points(count + 1, HairPoint{0, 0, 0, 0, 0});
    now_ = DeviceBuffer<HairPoint>(points), next_ = DeviceBuffer<HairPoint>(points);
    const std::vector<uint32_t> none(size_t(blocks_) * size_t(groups_of_block_), 0);
    for (auto* b : {&offset_, &capacity_, &length_}) *b = DeviceBuffer<uint32_t>(none);
}

void CohesionDevice::take_volumes(const std::vector<float>& volume, const std::vector<float>& saturation) {
    std::vector<float> wet;
    for (size_t k = 0; k < volume.size(); ++k) wet.push_back(volume[k] * saturation[k]);
    volume_.upload(volume.data(), volume.size()), wet_volume_.upload(wet.data(), wet.size());
}

CohesionBodies CohesionDevice::bodies() const {
    return {term_,
            {search_.view(), uint32_t(volume_.size()), particles_, now_.data(), next_.data(), beta_.data(),
             own_weight_.data(), list_.data(), offset_.data(), capacity_.data(), length_.data()}};
}

void CohesionDevice::launch_lists(const Vec3f* positions, FrameReport* report, cudaStream_t stream) {
    const CohesionBodies b = bodies();
    search_.launch(positions, stream);
    place<<<blocks_for(volume_.size(), small_block), small_block, 0, stream>>>(b, positions, volume_.data(),
                                                                               wet_volume_.data());
    measure<<<blocks_for(size_t(strands_), warp), warp, 0, stream>>>(b, strands_);
    build_lists<<<blocks_, unsigned(threads_), 0, stream>>>(b, strands_of_block_, groups_of_block_, report);
    check_cuda(cudaGetLastError(), "launch of the neighbour lists");
}

template <class T>
void CohesionDevice::launch_passes(const Vec3f* simulated, const SubstepMotion<T>* motion, Vec3f* displayed,
                                   cudaStream_t stream) {
    const CohesionBodies b = bodies();
    const HairPoint* now = now_.data();
    HairPoint* next = next_.data();
    for (int pass = 0; pass < term_.passes; ++pass) {
        jacobi<<<blocks_, unsigned(threads_), shared_bytes_, stream>>>(b, strands_of_block_, groups_of_block_,
                                                                       now, next);
        HairPoint* newer = next;
        next = const_cast<HairPoint*>(now), now = newer;
    }
    show<<<blocks_for(size_t(strands_), warp), warp, 0, stream>>>(
        b, strands_, now, simulated, rest_depth_.size() ? rest_depth_.data() : nullptr, motion, displayed);
    check_cuda(cudaGetLastError(), "launch of the cohesion passes");
}
template void CohesionDevice::launch_passes(const Vec3f*, const SubstepMotion<float>*, Vec3f*, cudaStream_t);
template void CohesionDevice::launch_passes(const Vec3f*, const SubstepMotion<double>*, Vec3f*, cudaStream_t);

void CohesionDevice::grow() {
    // Half as much again as was sought, and never less than before: of thousands of groups of moving hair one
    // or another would else ask every frame.
    const std::vector<uint32_t> length = length_.host();
    std::vector<uint32_t> capacity = capacity_.host(), offset;
    size_t total = 0;
    for (size_t group = 0; group < length.size(); ++group) {
        capacity[group] = std::max(capacity[group], length[group] * 3 / 2 + 16);
        offset.push_back(uint32_t(total));
        total += size_t(capacity[group]) * warp;
    }
    if (total > 0xffffffffu)
        throw Error("cohesion: more than 2^32 neighbours; a smaller [cohesion] radius may help");
    list_ = {};
    list_ = DeviceBuffer<uint32_t>(total);
    offset_.upload(offset.data(), offset.size());
    capacity_.upload(capacity.data(), capacity.size());
}

size_t CohesionDevice::bytes() const {
    size_t sum = search_.bytes();
    for (const auto* b : {&volume_, &wet_volume_, &rest_depth_, &beta_, &own_weight_}) sum += b->bytes();
    sum += now_.bytes() + next_.bytes();
    for (const auto* b : {&list_, &offset_, &capacity_, &length_}) sum += b->bytes();
    return sum;
}

}  // namespace wetcurl
