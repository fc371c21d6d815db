// Kernels of what follows the water: a thread a particle, and a thread a strand for its curl.
#include "cuda/water/soaking_device.h"

namespace wetcurl {

namespace {

// Strands are few, and each thread is long at work: small blocks reach all processors.
constexpr unsigned strand_threads = 32, particle_threads = 128;

unsigned blocks_for(size_t items, unsigned threads) { return unsigned((items + threads - 1) / threads); }

template <class T>
__global__ void __launch_bounds__(particle_threads)
    weigh(const Weighing weighing, size_t count, const float* saturation, const double* dry_mass,
          const SoakedStrands<T> to) {
    const size_t k = size_t(blockIdx.x) * particle_threads + threadIdx.x;
    if (k < count) weighing(k, saturation[k], dry_mass[k], to);
}

template <class T>
__global__ void __launch_bounds__(strand_threads)
    curl(const DryCurls dry, const float* saturation, Vec3d* target, Vec3d* points,
         const SoakedStrands<T> to) {
    const int s = int(blockIdx.x * strand_threads + threadIdx.x);
    if (s < dry.strands) dry.soak(s, saturation + size_t(s) * size_t(dry.edges + 1), target, points, to);
}

}  // namespace

template <class T>
void SoakingDevice::launch(const float* saturation, const double* dry_mass, const SoakedStrands<T>& to,
                           cudaStream_t stream) const {
    weigh<<<blocks_for(count_, particle_threads), particle_threads, 0, stream>>>(weighing_, count_,
                                                                                 saturation, dry_mass, to);
    if (dry_.curl)
        curl<<<blocks_for(size_t(dry_.strands), strand_threads), strand_threads, 0, stream>>>(
            dry_, saturation, target_.data(), points_.data(), to);
    check_cuda(cudaGetLastError(), "launch of what follows the water");
}
template void SoakingDevice::launch(const float*, const double*, const SoakedStrands<float>&,
                                    cudaStream_t) const;
template void SoakingDevice::launch(const float*, const double*, const SoakedStrands<double>&,
                                    cudaStream_t) const;

}  // namespace wetcurl
