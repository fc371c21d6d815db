// Kernels of forces on all strands at once: a thread a particle.
#include "base/device_buffer.h"
#include "cuda/device/tally.h"
#include "cuda/pair_forces/pair_forces_kernel.h"

namespace wetcurl {

namespace {

constexpr unsigned threads = 128;

unsigned blocks_for(size_t items) { return unsigned((items + threads - 1) / threads); }
__device__ uint32_t particle() { return blockIdx.x * threads + threadIdx.x; }

// Where forces are taken: where the scheme expects particles, or where they are.
template <class T>
struct Sight {
    StrandMemory<T> m;
    Bdf2<T> scheme;
    bool expected;
    __device__ Vec3d at(uint32_t id) const {
        return cast<double>(expected ? scheme.predicted(m.x[id], m.x_before[id], m.v[id]) : m.x[id]);
    }
};
template <class T>
__global__ void __launch_bounds__(threads)
    see_particles(const Sight<T> sight, uint32_t count, Vec3d* x, Vec3f* near) {
    const uint32_t id = particle();
    if (id >= count) return;
    const Vec3d at = sight.at(id);
    x[id] = at;
    if (near) near[id] = cast<float>(at - sight.at(0));
}
__global__ void __launch_bounds__(threads)
    take_points(const PairMemory m, const Vec3d* x, const double* mass, const float* saturation) {
    const uint32_t k = particle();
    if (k < m.search.count) m.take(k, x, mass, saturation);
}
template <class Pulls>
__global__ void __launch_bounds__(threads) prepare(const Pulls pulls, int pass) {
    const uint32_t k = particle();
    if (k < pulls.count()) pulls.prepare(pass, k);
}
template <class Pulls, class T>
__global__ void __launch_bounds__(threads)
    pull(const Pulls pulls, Write write, Vec3<T>* force, T* stiffness, unsigned long long* pairs) {
    const uint32_t k = particle();
    uint32_t found = 0;
    if (k < pulls.count()) {
        const Pull sum = pulls.pull(k);
        const uint32_t id = pulls.id(k);
        const bool adds = write == Write::added;
        force[id] = adds ? force[id] + cast<T>(sum.force) : cast<T>(sum.force);
        if (stiffness) stiffness[id] = adds ? stiffness[id] + T(sum.stiffness) : T(sum.stiffness);
        found = sum.pairs;
    }
    tally(found, pairs);
}
template <class Pulls>
__global__ void __launch_bounds__(threads) sum_energies(const Pulls pulls, Write write, double* of_block) {
    __shared__ double sum;
    const uint32_t k = particle();
    sum_of_block<threads>(k < pulls.count() ? pulls.energy(k) : 0, &sum);
    if (threadIdx.x == 0) of_block[blockIdx.x] = write == Write::added ? of_block[blockIdx.x] + sum : sum;
}

}  // namespace

template <class T>
void launch_sight(const StrandMemory<T>& memory, const Bdf2<T>* scheme, Vec3d* x, Vec3f* near,
                  cudaStream_t stream) {
    const size_t count = size_t(memory.strands) * size_t(memory.n);
    const Sight<T> sight{memory, scheme ? *scheme : Bdf2<T>(T(1), true), scheme != nullptr};
    see_particles<<<blocks_for(count), threads, 0, stream>>>(sight, uint32_t(count), x, near);
    check_cuda(cudaGetLastError(), "launch of the sight of particles");
}

void launch_points(const PairMemory& memory, const Vec3d* x, const double* mass, const float* saturation,
                   cudaStream_t stream) {
    take_points<<<blocks_for(memory.search.count), threads, 0, stream>>>(memory, x, mass, saturation);
    check_cuda(cudaGetLastError(), "launch of the points of pairs");
}

template <class T>
void launch_pulls(const AnyPulls& pulls, Write write, Vec3<T>* force, T* stiffness, unsigned long long* pairs,
                  cudaStream_t stream) {
    std::visit(
        [&](const auto& of) {
            const unsigned blocks = blocks_for(of.count());
            for (int pass = 0; pass < of.preparations; ++pass)
                prepare<<<blocks, threads, 0, stream>>>(of, pass);
            pull<<<blocks, threads, 0, stream>>>(of, write, force, stiffness, pairs);
        },
        pulls);
    check_cuda(cudaGetLastError(), "launch of forces on strands");
}

size_t energy_parts(size_t particles) { return blocks_for(particles); }
void launch_energies(const AnyPulls& pulls, Write write, double* parts, cudaStream_t stream) {
    std::visit(
        [&](const auto& of) {
            sum_energies<<<blocks_for(of.count()), threads, 0, stream>>>(of, write, parts);
        },
        pulls);
    check_cuda(cudaGetLastError(), "launch of the energy of forces on strands");
}

template void launch_sight(const StrandMemory<float>&, const Bdf2<float>*, Vec3d*, Vec3f*, cudaStream_t);
template void launch_sight(const StrandMemory<double>&, const Bdf2<double>*, Vec3d*, Vec3f*, cudaStream_t);
template void launch_pulls(const AnyPulls&, Write, Vec3f*, float*, unsigned long long*, cudaStream_t);
template void launch_pulls(const AnyPulls&, Write, Vec3d*, double*, unsigned long long*, cudaStream_t);

}  // namespace wetcurl
