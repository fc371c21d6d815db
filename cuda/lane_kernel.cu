// Steps as a kernel: a strand a thread, its numbers beside those of 31 others.
#include "base/device_buffer.h"
#include "cuda/chain_kernel.h"

namespace wetcurl {

namespace {

constexpr int warp = LaneNumbers::lanes;
// Seen on an H200: eight warps a processor, each with all registers that it asks for, beat twelve.
constexpr int at_once = 8;

template <class T, class Set>
__global__ void __launch_bounds__(warp, at_once)
    run_lanes(const __grid_constant__ ChainLaunch<T> launch, const Set set) {
    const int strand = int(blockIdx.x) * warp + int(threadIdx.x);
    if (strand >= launch.memory.strands) return;
    LaneStep<T> lane(launch.memory, launch.constants, launch.lanes, launch.room, strand);
    int limited = 0;
    for (int k = 0; k < launch.substeps; ++k) limited += lane.step(set, launch.motion[k], launch.is_first(k));
    if (limited) atomicAdd(launch.limited, static_cast<unsigned long long>(limited));
}

// Numbers of 32 strands, 32 along each: so both sides are read and written by whole lines.
template <class T>
struct Tile {
    TakenAlong<T> taken;
    int n, strands;
    LaneNumbers of;
    T* lanes;
    int strand, lane;
    unsigned number, all;  // of a strand: the tile's first, and how many
    __device__ Tile(const TakenAlong<T>& t, int particles, int strand_count, const LaneNumbers& numbers,
                    T* room)
        : taken(t),
          n(particles),
          strands(strand_count),
          of(numbers),
          lanes(room),
          strand(int(blockIdx.x) * warp),
          lane(int(threadIdx.x)),
          number(blockIdx.y * warp),
          all(unsigned(particles) * t.numbers) {}
    // Calls f(k, place) for the numbers of the k-th strand, a lane a number.
    template <class F>
    __device__ void each_strand(F f) const {
        for (int k = 0; k < warp && strand + k < strands; ++k)
            if (number + unsigned(lane) < all) f(k, size_t(strand + k) * all + number + unsigned(lane));
    }
    // Calls f(k, place) for the k-th number, as lanes hold it from `first` on, a lane a strand.
    template <class F>
    __device__ void each_number(unsigned first, F f) const {
        for (unsigned k = 0; k < warp && number + k < all; ++k)
            if (strand + lane < strands)
                f(int(k), of.place(n, strand + lane, int((number + k) / taken.numbers),
                                   first + (number + k) % taken.numbers));
    }
};
template <class T>
__global__ void __launch_bounds__(warp)
    take_along(TakenAlong<T> taken, int n, int strands, LaneNumbers of, T* lanes) {
    __shared__ T near[warp][warp + 1];
    const Tile<T> tile(taken, n, strands, of, lanes);
    tile.each_strand([&](int k, size_t at) { near[k][tile.lane] = taken.values[at]; });
    __syncwarp();
    tile.each_number(taken.first, [&](int k, size_t at) { lanes[at] = near[tile.lane][k]; });
}
template <class T>
__global__ void __launch_bounds__(warp)
    bring_back(TakenAlong<T> taken, int n, int strands, LaneNumbers of, T* lanes) {
    __shared__ T near[warp][warp + 1];
    const Tile<T> tile(taken, n, strands, of, lanes);
    tile.each_number(taken.after, [&](int k, size_t at) { near[tile.lane][k] = lanes[at]; });
    __syncwarp();
    tile.each_strand([&](int k, size_t at) { taken.changed[at] = near[k][tile.lane]; });
}

unsigned tiles(unsigned numbers) { return (numbers + warp - 1) / warp; }

}  // namespace

template <class T>
void launch_lanes(const ChainLaunch<T>& launch, cudaStream_t stream) {
    const StrandMemory<T>& m = launch.memory;
    const unsigned groups = tiles(unsigned(m.strands));
    auto for_each = [&](auto f) { for_each_taken_along(m, launch.lanes, launch.substeps % 2, f); };
    auto grid = [&](const TakenAlong<T>& t) { return dim3(groups, tiles(unsigned(m.n) * t.numbers)); };
    for_each([&](const TakenAlong<T>& t) {
        take_along<<<grid(t), warp, 0, stream>>>(t, m.n, m.strands, launch.lanes, launch.room);
    });
    with_set(launch.set, [&](auto set) { run_lanes<<<groups, warp, 0, stream>>>(launch, set); });
    for_each([&](const TakenAlong<T>& t) {
        if (t.changed) bring_back<<<grid(t), warp, 0, stream>>>(t, m.n, m.strands, launch.lanes, launch.room);
    });
    check_cuda(cudaGetLastError(), "launch of the substeps");
}

template void launch_lanes(const ChainLaunch<float>&, cudaStream_t);
template void launch_lanes(const ChainLaunch<double>&, cudaStream_t);

}  // namespace wetcurl
