// Kernels of contact between strands: a thread a particle.
#include "cuda/device/tally.h"
#include "cuda/strand_contact/strand_contact_on_device.h"

namespace wetcurl {

namespace {

constexpr unsigned threads = 128;

__device__ uint32_t particle() { return blockIdx.x * threads + threadIdx.x; }

template <class T>
__global__ void __launch_bounds__(threads) see(const Vec3<T>* x, uint32_t count, Vec3f* positions) {
    const uint32_t k = particle();
    if (k < count) positions[k] = cast<float>(x[k]);
}
template <class T>
__global__ void __launch_bounds__(threads)
    count_contacts(const StrandContactKernelBody<T> b, const StrandMemory<T> memory,
                   unsigned long long* pairs) {
    const uint32_t k = particle();
    tally(k < b.search.count ? b.count(k, memory) : 0, pairs);
}
template <class T>
__global__ void __launch_bounds__(threads)
    push(const StrandContactKernelBody<T> b, const StrandMemory<T> memory) {
    const uint32_t k = particle();
    if (k < b.search.count) b.push(k, memory);
}

}  // namespace

template <class T>
StrandContactOnDevice<T>::StrandContactOnDevice(const Scene& scene, const ChainState<T>& state)
    : term_(*scene.strand_contact),
      drawn_(scene.groom.rest.points),
      positions_(drawn_.size()),
      search_(drawn_.size(), state.n, strand_contact_radius(term_),
              cast<float>(scene.head_at(0).translation)),
      point_(drawn_.size()),
      contacts_(drawn_.size()) {
    check_cuda(cudaStreamSynchronize(nullptr), "groom");  // streams of launches do not wait for this one
}

template <class T>
void StrandContactOnDevice<T>::launch(const StrandMemory<T>& memory, double dt, unsigned long long* pairs,
                                      cudaStream_t stream) {
    const uint32_t count = uint32_t(drawn_.size());
    const unsigned blocks = (count + threads - 1) / threads;
    see<<<blocks, threads, 0, stream>>>(memory.x, count, positions_.data());
    search_.launch(positions_.data(), stream);
    const StrandContactKernelBody<T> bodies{term_,          StrandContact::Step(term_, dt),
                                            search_.view(), drawn_.data(),
                                            point_.data(),  contacts_.data()};
    count_contacts<<<blocks, threads, 0, stream>>>(bodies, memory, pairs);
    push<<<blocks, threads, 0, stream>>>(bodies, memory);
    check_cuda(cudaGetLastError(), "launch of the contact between strands");
}

template <class T>
void StrandContactOnDevice<T>::list(BufferList& buffers) const {
    buffers.push_back({StrandContact::name, drawn_.bytes() + positions_.bytes() + search_.bytes() +
                                                point_.bytes() + contacts_.bytes()});
}

template class StrandContactOnDevice<float>;
template class StrandContactOnDevice<double>;

}  // namespace wetcurl
