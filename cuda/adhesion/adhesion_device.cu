// Kernels of a network in Eq 11's place: a thread a particle.
#include "cuda/adhesion/adhesion_device.h"

namespace wetcurl {

namespace {

constexpr unsigned threads = 128;

__device__ uint32_t particle() { return blockIdx.x * threads + threadIdx.x; }

template <class T>
__global__ void __launch_bounds__(threads)
    see(const __grid_constant__ AdhesionKernelBody<T> b, const StrandMemory<T> memory, uint32_t count,
        const SubstepMotion<T>* motion) {
    const uint32_t k = particle();
    if (k < count) b.see(k, memory, *motion);
}
template <class T>
__global__ void __launch_bounds__(threads)
    ask(const __grid_constant__ AdhesionKernelBody<T> b, const StrandMemory<T> memory, uint32_t count) {
    const uint32_t k = particle();
    if (k < count) b.ask(k, memory);
}

}  // namespace

template <class T>
AdhesionDevice<T>::AdhesionDevice(const Adhesion& term, const DenseLayers& layers, size_t particles)
    : features_(term),
      numbers_(layers.numbers()),
      before_(particles),
      network_(layers.view(numbers_.data())) {
    check_cuda(cudaStreamSynchronize(nullptr), "network");  // streams of launches do not wait for this one
}

template <class T>
void AdhesionDevice<T>::launch(const StrandMemory<T>& memory, const SubstepMotion<T>* motion,
                               const NearestView<T>& near, T* answer, cudaStream_t stream) const {
    const uint32_t count = uint32_t(before_.size());
    const unsigned blocks = (count + threads - 1) / threads;
    const AdhesionKernelBody<T> bodies{features_, network_, near, answer, before_.data()};
    see<<<blocks, threads, 0, stream>>>(bodies, memory, count, motion);
    ask<<<blocks, threads, 0, stream>>>(bodies, memory, count);
    check_cuda(cudaGetLastError(), "launch of the adhesion network");
}

template class AdhesionDevice<float>;
template class AdhesionDevice<double>;

}  // namespace wetcurl
