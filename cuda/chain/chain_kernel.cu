// Steps as a kernel: some strands a block of threads, which keeps them in its processor's own memory.

#include "cuda/chain/chain_kernel.h"
#include "cuda/device/cuda_owners.h"

namespace wetcurl {

namespace {

constexpr int warp = 32;
// Seen on an H200: more blocks have fewer threads for what goes along a strand, fewer wait for that together.
constexpr int threads = 192, blocks_at_once = 2;
constexpr int most_strands = 8;  // of a block

// `near`: their workspace is there; else in the device's memory.
template <class T, class Set, bool near>
__global__ void __launch_bounds__(threads, blocks_at_once)
    run_substeps(const __grid_constant__ ChainLaunch<T> launch, const Set set) {
    extern __shared__ __align__(32) unsigned char own[];
    __shared__ StrandFlags flags[most_strands];
    const int first = int(blockIdx.x) * launch.group.strands, left = launch.memory.strands - first,
              count = left < launch.group.strands ? left : launch.group.strands;
    T* workspace = reinterpret_cast<T*>(own);
    if constexpr (!near) workspace = launch.workspace + blockIdx.x * (launch.group.bytes / sizeof(T));
    StrandStep<T, Set, Block> strands(launch.memory, launch.constants, set,
                                      {Block{}, int(threadIdx.x), threads}, first, count, workspace, flags);
    strands.load();
    for (int k = 0; k < launch.substeps; ++k) strands.step(launch.motion[k], launch.is_first(k));
    strands.store();
    if (strands.limited) atomicAdd(launch.limited, static_cast<unsigned long long>(strands.limited));
}

template <class T>
__global__ void __launch_bounds__(threads)
    find_nearest(const Vec3<T>* x, size_t count, const SubstepMotion<T>* motion, T* phi, Vec3<T>* normal,
                 Vec3<T>* velocity) {
    const size_t k = size_t(blockIdx.x) * threads + threadIdx.x;
    if (k >= count) return;
    normal[k] = {T(0), T(1), T(0)}, velocity[k] = {T(0), T(0), T(0)};
    sample_nearest(*motion, x[k], phi[k], normal[k], velocity[k]);
}

// A warp a strand.
template <class T>
__global__ void unpack(const StrandMemory<T> memory, Vec3f* positions, int* diverged) {
    const int strand = int(blockIdx.x * blockDim.x + threadIdx.x) / warp, lane = int(threadIdx.x) % warp;
    if (strand >= memory.strands) return;
    const size_t begin = size_t(strand) * size_t(memory.n);
    const Vec3<T> root = memory.x[begin];
    T length = 0;
    for (int i = 0; i + 1 < memory.n; ++i) length += memory.rest_length[begin + size_t(i)];
    bool strays = false;
    for (int i = lane; i < memory.n; i += warp) {
        const Vec3<T> p = memory.x[begin + size_t(i)];
        positions[begin + size_t(i)] = cast<float>(p);
        strays |= !(norm(p - root) <= 10 * length);  // NaN too
    }
    if (strays) atomicMin(diverged, strand);
}

int number_of(cudaDeviceAttr attribute) {
    int device = 0, number = 0;
    check_cuda(cudaGetDevice(&device), "device");
    check_cuda(cudaDeviceGetAttribute(&number, attribute, device), "device");
    return number;
}

template <class T, class Set, bool near>
void run(const ChainLaunch<T>& launch, const Set& set, cudaStream_t stream) {
    const auto kernel = run_substeps<T, Set, near>;
    const size_t own = near ? launch.group.bytes : 0;
    if (near) allow_shared_memory(kernel);
    const int blocks = (launch.memory.strands + launch.group.strands - 1) / launch.group.strands;
    kernel<<<unsigned(blocks), threads, own, stream>>>(launch, set);
    check_cuda(cudaGetLastError(), "launch of the substeps");
}

}  // namespace

template <class T>
StrandGroup strand_group(int n, int strands, const ChainTerms& terms) {
    const bool limits = std::get<Slot<StrainLimit>>(terms).has_value();
    auto bytes = [&](int count) {
        return (strand_workspace<T>(n, count, limits) * sizeof(T) + 31) / 32 * 32;
    };
    // A kernel has some of it for itself.
    constexpr size_t reserved = 2048;
    const size_t of_a_block = size_t(number_of(cudaDevAttrMaxSharedMemoryPerBlockOptin)) - reserved,
                 of_each = size_t(number_of(cudaDevAttrMaxSharedMemoryPerMultiprocessor)) / blocks_at_once -
                           reserved;
    int most = 1;
    while (most < most_strands && bytes(most + 1) <= of_each) ++most;
    // As few as take no more rounds of blocks than the most would.
    auto rounds = [](int jobs, int at_once) { return (jobs + at_once - 1) / at_once; };
    const int share = rounds(strands, number_of(cudaDevAttrMultiProcessorCount) * blocks_at_once),
              count = rounds(share, rounds(share, most));
    return {count, bytes(count), bytes(count) <= of_a_block};
}

template <class T>
void launch_chain(const ChainLaunch<T>& launch, cudaStream_t stream) {
    if (!launch.group.near) return run<T, AnySet, false>(launch, {launch.set}, stream);
    with_set(launch.set, [&](auto set) { run<T, decltype(set), true>(launch, set, stream); });
}

template <class T>
void launch_nearest(const StrandMemory<T>& memory, const SubstepMotion<T>* motion, T* phi, Vec3<T>* normal,
                    Vec3<T>* velocity, cudaStream_t stream) {
    const size_t count = size_t(memory.strands) * size_t(memory.n);
    find_nearest<<<unsigned((count + threads - 1) / threads), threads, 0, stream>>>(memory.x, count, motion,
                                                                                    phi, normal, velocity);
    check_cuda(cudaGetLastError(), "launch of the nearest surfaces");
}

template <class T>
void launch_unpack(const StrandMemory<T>& memory, Vec3f* positions, int* diverged, cudaStream_t stream) {
    constexpr int of_a_block = 8 * warp;
    const unsigned blocks = unsigned((size_t(memory.strands) * warp + of_a_block - 1) / of_a_block);
    unpack<<<blocks, of_a_block, 0, stream>>>(memory, positions, diverged);
    check_cuda(cudaGetLastError(), "launch of the unpacking");
}

template StrandGroup strand_group<float>(int, int, const ChainTerms&);
template StrandGroup strand_group<double>(int, int, const ChainTerms&);
template void launch_chain(const ChainLaunch<float>&, cudaStream_t);
template void launch_chain(const ChainLaunch<double>&, cudaStream_t);
template void launch_nearest(const StrandMemory<float>&, const SubstepMotion<float>*, float*, Vec3<float>*,
                             Vec3<float>*, cudaStream_t);
template void launch_nearest(const StrandMemory<double>&, const SubstepMotion<double>*, double*,
                             Vec3<double>*, Vec3<double>*, cudaStream_t);
template void launch_unpack(const StrandMemory<float>&, Vec3f*, int*, cudaStream_t);
template void launch_unpack(const StrandMemory<double>&, Vec3f*, int*, cudaStream_t);

}  // namespace wetcurl
