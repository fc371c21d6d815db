// Steps as a kernel: a lane a strand, some warps for each 32.
#include "base/device_buffer.h"
#include "cuda/chain_kernel.h"

namespace wetcurl {

namespace {

constexpr int warp = Lanes<float>::lanes;

// A block of strands by `warps` of them, so many blocks on a multiprocessor at once.
template <class T, class Set, int warps, int blocks>
__global__ void __launch_bounds__(warps* warp, blocks)
    run_substeps(const __grid_constant__ ChainLaunch<T> launch, const Set set) {
    __shared__ unsigned flags[3][warp];
    for (int k = int(threadIdx.x); k < 3 * warp; k += warps * warp) flags[k / warp][k % warp] = 0;
    __syncthreads();
    __shared__ T middle[StrandSystem<T>::middle_size * warp];
    StrandStep<T> strands(launch.memory, launch.constants, int(blockIdx.x),
                          {int(threadIdx.x) % warp, int(threadIdx.x) / warp, warps, flags}, middle);
    int limited = 0;
    for (int k = 0; k < launch.substeps; ++k)
        limited += strands.step(set, launch.motion[k], launch.first && k == 0);
    if (limited) atomicAdd(launch.limited, static_cast<unsigned long long>(limited));
}

template <class T>
__global__ void unpack(const StrandMemory<T> memory, int strands, Vec3f* positions, int* diverged) {
    const int strand = int(blockIdx.x) * warp + int(threadIdx.x);
    if (strand >= strands) return;
    const size_t row = size_t(blockIdx.x) * size_t(memory.n) * warp;
    const LaneArray<Vec3<T>, T> x{memory.x + row * 3 + threadIdx.x};
    const LaneArray<T, const T> rest_length{memory.rest_length + row + threadIdx.x};
    const Vec3<T> root = x[0];
    T length = 0, farthest = 0;
    bool finite = true;
    Vec3f* out = positions + size_t(strand) * size_t(memory.n);
    for (int i = 0; i < memory.n; ++i) {
        const Vec3<T> p = x[i];
        out[i] = cast<float>(p);
        const T away = norm(p - root);
        finite = finite && away < T(1e30);  // false for NaN
        farthest = maximum(farthest, away);
        if (i + 1 < memory.n) length += rest_length[i];
    }
    if (!finite || farthest > 10 * length) atomicMin(diverged, strand);
}

template <class T, class Set>
void run(const ChainLaunch<T>& launch, const Set& set, cudaStream_t stream) {
    int device = 0, processors = 0;
    check_cuda(cudaGetDevice(&device), "device");
    check_cuda(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device), "device");
    // Where there are few strands, more warps for each.
    if (launch.blocks <= processors)
        run_substeps<T, Set, 16, 1><<<unsigned(launch.blocks), 16 * warp, 0, stream>>>(launch, set);
    else
        run_substeps<T, Set, 5, 3><<<unsigned(launch.blocks), 5 * warp, 0, stream>>>(launch, set);
    check_cuda(cudaGetLastError(), "launch of the substeps");
}

}  // namespace

template <class T>
void launch_chain(const ChainLaunch<T>& launch, cudaStream_t stream) {
    using namespace present;
    constexpr unsigned dry = these<Stretch, Bend, Twist, Core>,
                       wet = these<Stretch, Bend, Twist, Core, Stiffness>;
    constexpr unsigned solid = 1u << contact;
    // Common sets have kernels of their own, with nothing in them of what is absent.
    switch (launch.set) {
        case dry:
            return run(launch, ExactSet<dry>(), stream);
        case wet | solid:
            return run(launch, ExactSet<wet | solid>(), stream);
        default:
            return run(launch, AnySet{launch.set}, stream);
    }
}

template <class T>
void launch_unpack(const StrandMemory<T>& memory, int strands, Vec3f* positions, int* diverged,
                   cudaStream_t stream) {
    const unsigned blocks = unsigned((strands + warp - 1) / warp);
    unpack<<<blocks, warp, 0, stream>>>(memory, strands, positions, diverged);
    check_cuda(cudaGetLastError(), "launch of the unpacking");
}

template void launch_chain(const ChainLaunch<float>&, cudaStream_t);
template void launch_chain(const ChainLaunch<double>&, cudaStream_t);
template void launch_unpack(const StrandMemory<float>&, int, Vec3f*, int*, cudaStream_t);
template void launch_unpack(const StrandMemory<double>&, int, Vec3f*, int*, cudaStream_t);

}  // namespace wetcurl
