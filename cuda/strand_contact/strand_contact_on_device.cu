// Kernels of contact between strands: a thread a particle or a place.
#include "cuda/device/tally.h"
#include "cuda/strand_contact/strand_contact_on_device.h"

namespace wetcurl {

namespace {

constexpr unsigned threads = 128;

unsigned blocks_for(size_t items) { return unsigned((items + threads - 1) / threads); }
__device__ uint32_t item() { return blockIdx.x * threads + threadIdx.x; }

// To a particle's sum.
struct AddWhole {
    ContactSum* sum;
    __device__ void operator()(uint32_t id, const Vec3f& force, float stiffness) const {
        atomicAdd(&sum[id].x, ContactSum::whole(force.x, ContactSum::of_force));
        atomicAdd(&sum[id].y, ContactSum::whole(force.y, ContactSum::of_force));
        atomicAdd(&sum[id].z, ContactSum::whole(force.z, ContactSum::of_force));
        if (stiffness > 0)
            atomicAdd(&sum[id].stiffness, ContactSum::whole(stiffness, ContactSum::of_stiffness));
    }
};

template <class T>
__global__ void __launch_bounds__(threads)
    see(const StrandContactKernelBody<T> b, const StrandMemory<T> m, const Bdf2<T> scheme) {
    if (const uint32_t id = item(); id < b.search.count) b.see(id, m, scheme);
}
template <class T>
__global__ void __launch_bounds__(threads)
    link(const StrandContactKernelBody<T> b, unsigned long long* links) {
    const uint32_t k = item();
    tally(k < b.search.count ? b.link(k) : 0, links);
}
template <class T>
__global__ void __launch_bounds__(threads) act(const StrandContactKernelBody<T> b) {
    if (const uint32_t which = item(); which < b.search.count * b.places.each) b.act(which, AddWhole{b.sum});
}
template <class T>
__global__ void __launch_bounds__(threads)
    give(const StrandContactKernelBody<T> b, bool adds, Vec3<T>* force, T* stiffness) {
    if (const uint32_t id = item(); id < b.search.count)
        b.give(id, adds, force, stiffness, [](uint32_t& shared, uint32_t bits) { atomicMax(&shared, bits); });
}
template <class T>
__global__ void __launch_bounds__(threads)
    see_change(const StrandContactKernelBody<T> b, const StrandMemory<T> m, const Bdf2<T> scheme) {
    if (const uint32_t id = item(); b.corrects() && id < b.search.count) b.see_change(id, m, scheme);
}
template <class T>
__global__ void __launch_bounds__(threads) hold_back(const StrandContactKernelBody<T> b) {
    if (const uint32_t which = item(); b.corrects() && which < b.search.count * b.places.each)
        b.hold_back(which, AddWhole{b.sum});
}
template <class T>
__global__ void __launch_bounds__(threads)
    correct(const StrandContactKernelBody<T> b, const StrandMemory<T> m, const Bdf2<T> scheme) {
    if (const uint32_t id = item(); b.corrects() && id < b.search.count) b.correct(id, m, scheme);
}
template <class T>
__global__ void __launch_bounds__(threads)
    sum_energies(const StrandContactKernelBody<T> b, const StrandMemory<T> m, double* of_block) {
    const uint32_t id = item();
    sum_of_block<threads>(id < b.search.count ? b.energy(id, m) : 0, &of_block[blockIdx.x]);
}

}  // namespace

template <class T>
StrandContactOnDevice<T>::StrandContactOnDevice(const Scene& scene, const ChainState<T>& state)
    : term_(*scene.strand_contact),
      places_{uint32_t(state.n), term_.places(longest_edge(scene.groom.rest))},
      reach_(float(term_.reach(longest_edge(scene.groom.rest)))),
      substeps_(scene.integrator.substeps),
      drawn_(scene.groom.rest.points),
      x_(drawn_.size()),
      v_(drawn_.size()),
      mass_(drawn_.size()),
      saturation_(drawn_.size()),
      search_(drawn_.size(), state.n, double(reach_), Vec3f{0, 0, 0}),
      links_(std::vector<StrandLink>(drawn_.size() * places_.each * most_links)),
      found_(links_.size()),
      count_(std::vector<uint8_t>(drawn_.size() * places_.each, 0)),
      acting_(links_.size()),
      sum_(drawn_.size()),
      stiffest_(std::vector<uint32_t>(1, 0)),
      energy_(blocks_for(drawn_.size())) {
    check_cuda(cudaStreamSynchronize(nullptr), "groom");  // streams of launches do not wait for this one
}

template <class T>
StrandContactKernelBody<T> StrandContactOnDevice<T>::bodies(double dt) const {
    return {term_,          StrandContact::Step(term_, dt),
            places_,        reach_,
            search_.view(), drawn_.data(),
            x_.data(),      v_.data(),
            mass_.data(),   saturation_.data(),
            links_.data(),  found_.data(),
            count_.data(),  acting_.data(),
            sum_.data(),    stiffest_.data()};
}

template <class T>
void StrandContactOnDevice<T>::launch(const StrandMemory<T>& memory, const Bdf2<T>& scheme, double dt,
                                      bool adds, Vec3<T>* force, T* stiffness, unsigned long long* links,
                                      cudaStream_t stream) {
    const auto b = bodies(dt);
    const unsigned particles = blocks_for(drawn_.size());
    see<<<particles, threads, 0, stream>>>(b, memory, scheme);
    if (left_ == 0) {
        left_ = substeps_, found_now_ = true;
        search_.launch(x_.data(), stream);
        link<<<particles, threads, 0, stream>>>(b, links);
        copy_on_device(links_.data(), found_.data(), links_.size(), stream);
    }
    --left_;
    act<<<blocks_for(count_.size()), threads, 0, stream>>>(b);
    give<<<particles, threads, 0, stream>>>(b, adds, force, stiffness);
    check_cuda(cudaGetLastError(), "launch of the contact between strands");
}

template <class T>
void StrandContactOnDevice<T>::launch_correction(const StrandMemory<T>& memory, const Bdf2<T>& scheme,
                                                 double dt, cudaStream_t stream) const {
    const auto b = bodies(dt);
    const unsigned particles = blocks_for(drawn_.size());
    see_change<<<particles, threads, 0, stream>>>(b, memory, scheme);
    hold_back<<<blocks_for(count_.size()), threads, 0, stream>>>(b);
    correct<<<particles, threads, 0, stream>>>(b, memory, scheme);
    check_cuda(cudaGetLastError(), "launch of the contact's correction");
}

template <class T>
void StrandContactOnDevice<T>::launch_energies(const StrandMemory<T>& memory, cudaStream_t stream) const {
    sum_energies<<<blocks_for(drawn_.size()), threads, 0, stream>>>(bodies(1), memory, energy_.device.data());
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
    const std::vector<uint8_t> count = links_in_places(links);
    links_.upload(links.data(), links.size()), count_.upload(count.data(), count.size());
}

template <class T>
void StrandContactOnDevice<T>::list(BufferList& buffers) const {
    buffers.push_back({StrandContact::name, drawn_.bytes() + x_.bytes() + v_.bytes() + mass_.bytes() +
                                                saturation_.bytes() + search_.bytes() + links_.bytes() +
                                                found_.bytes() + count_.bytes() + acting_.bytes() +
                                                sum_.bytes() + stiffest_.bytes() + energy_.device.bytes()});
}

template class StrandContactOnDevice<float>;
template class StrandContactOnDevice<double>;

}  // namespace wetcurl
