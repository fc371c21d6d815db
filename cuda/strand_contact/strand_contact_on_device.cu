// Kernels of contact between strands: a thread a particle or a link, and blocks that add up a strand's.
#include <cub/device/device_scan.cuh>

#include "cuda/device/tally.h"
#include "cuda/strand_contact/strand_contact_on_device.h"

namespace wetcurl {

namespace {

constexpr unsigned threads = 128;

unsigned blocks_for(size_t items) { return unsigned((items + threads - 1) / threads); }
__device__ uint32_t item() { return blockIdx.x * threads + threadIdx.x; }

template <class T>
__global__ void __launch_bounds__(threads)
    see(const StrandContactKernelBody<T> b, const StrandMemory<T> m, const Bdf2<T> scheme, bool finds) {
    if (const uint32_t id = item(); id < b.particle_count()) b.see(id, m, scheme, finds);
}
template <class T>
__global__ void __launch_bounds__(threads)
    link(const StrandContactKernelBody<T> b, unsigned long long* links) {
    const uint32_t k = item();
    tally(k < b.particle_count() ? b.link(k) : 0, links);
}
template <class T>
__global__ void __launch_bounds__(threads) count_links(const StrandContactKernelBody<T> b) {
    if (const uint32_t l = item(); l < b.link_count())
        b.count_link(l, [](uint32_t& shared, uint32_t more) { return atomicAdd(&shared, more); });
}
template <class T>
__global__ void __launch_bounds__(threads) list_links(const StrandContactKernelBody<T> b) {
    if (const uint32_t l = item(); l < b.link_count()) b.list_link(l);
}
template <class T>
__global__ void __launch_bounds__(threads) act(const StrandContactKernelBody<T> b) {
    if (const uint32_t l = item(); l < b.link_count()) b.act(l);
}

// Whole numbers of 64 bits in a block's memory, by two of 32, which it adds at once.
struct SharedWhole {
    uint32_t low, high;
    __device__ void add(ContactSum::Whole more) {
        if (more == 0) return;
        const uint32_t part = uint32_t(more), before = atomicAdd(&low, part);
        if (const uint32_t rest = uint32_t(more >> 32) + (before + part < part); rest != 0)
            atomicAdd(&high, rest);
    }
    __device__ ContactSum::Whole whole() const { return ContactSum::Whole(high) << 32 | low; }
};
// A block a strand: calls then(particle, sum) for all of its particles, so many at a time.
template <class T, class Then>
__device__ void for_each_sum(const StrandContactKernelBody<T>& b, Then then) {
    constexpr uint32_t at_once = 256;
    __shared__ SharedWhole sum[4][at_once];
    const uint32_t strand = blockIdx.x, acts = b.acts_on(strand), n = b.places.n;
    for (uint32_t from = 0; from < n; from += at_once) {
        const uint32_t many = n - from < at_once ? n - from : at_once;
        for (uint32_t i = threadIdx.x; i < many; i += threads)
            for (auto& of : sum) of[i] = {0, 0};
        __syncthreads();
        for (uint32_t k = threadIdx.x; k < acts; k += threads)
            b.add_up(strand, k, [&](uint32_t particle, const ContactSum& more) {
                const uint32_t i = particle - from;
                if (i >= many) return;
                sum[0][i].add(more.x), sum[1][i].add(more.y), sum[2][i].add(more.z);
                sum[3][i].add(more.stiffness);
            });
        __syncthreads();
        for (uint32_t i = threadIdx.x; i < many; i += threads)
            then(strand * n + from + i,
                 ContactSum{sum[0][i].whole(), sum[1][i].whole(), sum[2][i].whole(), sum[3][i].whole()});
        __syncthreads();
    }
}
template <class T>
__global__ void __launch_bounds__(threads)
    give(const StrandContactKernelBody<T> b, bool adds, Vec3<T>* force, T* stiffness) {
    for_each_sum(b, [&](uint32_t id, const ContactSum& sum) { b.give(id, sum, adds, force, stiffness); });
}
template <class T>
__global__ void __launch_bounds__(threads)
    sum_energies(const StrandContactKernelBody<T> b, const StrandMemory<T> m, double* of_block) {
    const uint32_t l = item();
    sum_of_block<threads>(l < b.link_count() ? b.energy(l, m) : 0, &of_block[blockIdx.x]);
}

// In place: how many links lead to the strands before.
cudaError_t scan(uint32_t* begin, uint32_t strands, void* memory, size_t& bytes, cudaStream_t stream) {
    return cub::DeviceScan::ExclusiveSum(memory, bytes, begin, begin, int(strands + 1), stream);
}

}  // namespace

template <class T>
StrandContactOnDevice<T>::StrandContactOnDevice(const Scene& scene, const ChainState<T>& state)
    : StrandContactOnDevice(scene, state, longest_edge(scene.groom.rest)) {}

template <class T>
StrandContactOnDevice<T>::StrandContactOnDevice(const Scene& scene, const ChainState<T>& state, double edge)
    : term_(*scene.strand_contact),
      places_{uint32_t(state.n), term_.places(edge, state.n)},
      reach_(float(term_.reach(edge))),
      substeps_(scene.integrator.substeps),
      drawn_(scene.groom.rest.points),
      particles_(drawn_.size()),
      x_(drawn_.size()),
      search_(drawn_.size(), state.n, cell_side(scene.groom.rest, double(reach_)), Vec3f{0, 0, 0}),
      links_(std::vector<StrandLink>(size_t(state.strands) * places_.count * most_links)),
      found_(links_.size()),
      other_(links_.size()),
      force_(links_.size()),
      rank_(links_.size()),
      begin_(size_t(state.strands) + 1),
      leading_(links_.size()),
      energy_(blocks_for(links_.size())) {
    size_t bytes = 0;
    check_cuda(scan(nullptr, uint32_t(state.strands), nullptr, bytes, nullptr), "size of the scan");
    scan_memory_ = DeviceBuffer<char>(bytes);
    check_cuda(cudaStreamSynchronize(nullptr), "groom");  // streams of launches do not wait for this one
}

template <class T>
StrandContactKernelBody<T> StrandContactOnDevice<T>::bodies(double dt) const {
    return {.term = term_,
            .step = StrandContact::Step(term_, dt),
            .places = places_,
            .reach = reach_,
            .search = search_.view(),
            .drawn = drawn_.data(),
            .particles = particles_.data(),
            .x = x_.data(),
            .links = links_.data(),
            .found = found_.data(),
            .other = other_.data(),
            .force = force_.data(),
            .rank = rank_.data(),
            .begin = begin_.data(),
            .leading = leading_.data()};
}

template <class T>
void StrandContactOnDevice<T>::launch(const StrandMemory<T>& memory, const Bdf2<T>& scheme, double dt,
                                      bool adds, Vec3<T>* force, T* stiffness, unsigned long long* links,
                                      cudaStream_t stream) {
    const auto b = bodies(dt);
    const unsigned particles = blocks_for(drawn_.size()), all_links = blocks_for(links_.size()),
                   strands = b.strand_count();
    const bool finds = left_ == 0;
    see<<<particles, threads, 0, stream>>>(b, memory, scheme, finds);
    if (finds) {
        left_ = substeps_, found_now_ = true;
        search_.launch(x_.data(), stream);
        link<<<particles, threads, 0, stream>>>(b, links);
        count_links<<<all_links, threads, 0, stream>>>(b);
        size_t bytes = scan_memory_.size();
        check_cuda(scan(begin_.data(), strands, scan_memory_.data(), bytes, stream), "scan of links");
        list_links<<<all_links, threads, 0, stream>>>(b);
    }
    --left_;
    act<<<all_links, threads, 0, stream>>>(b);
    give<<<strands, threads, 0, stream>>>(b, adds, force, stiffness);
    check_cuda(cudaGetLastError(), "launch of the contact between strands");
}

template <class T>
void StrandContactOnDevice<T>::launch_energies(const StrandMemory<T>& memory, cudaStream_t stream) const {
    sum_energies<<<blocks_for(links_.size()), threads, 0, stream>>>(bodies(1), memory, energy_.device.data());
    check_cuda(cudaGetLastError(), "launch of the energy of contact between strands");
}

template <class T>
void StrandContactOnDevice<T>::save(Carried& to) const {
    check_cuda(cudaDeviceSynchronize(), "contact between strands");
    to[carried_links] = numbers_of(links_.host());
}
template <class T>
void StrandContactOnDevice<T>::resume(const Carried& from) {
    check_cuda(cudaDeviceSynchronize(), "contact between strands");
    const std::vector<StrandLink> links = links_of(from.at(carried_links));
    links_.upload(links.data(), links.size());
}

template <class T>
void StrandContactOnDevice<T>::list(BufferList& buffers) const {
    size_t bytes = search_.bytes() + energy_.device.bytes();
    auto add = [&](const auto&... of) { bytes += (of.bytes() + ...); };
    add(drawn_, particles_, x_, links_, found_, other_, force_, rank_, begin_, leading_, scan_memory_);
    buffers.push_back({StrandContact::name, bytes});
}

template class StrandContactOnDevice<float>;
template class StrandContactOnDevice<double>;

}  // namespace wetcurl
