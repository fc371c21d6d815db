// Kernels of the search, a thread a particle, and the scan between them.
#include <cub/device/device_scan.cuh>

#include "cuda/device/cell_search_device.h"

namespace wetcurl {

namespace {

constexpr unsigned threads = 128;

unsigned blocks_for(size_t items) { return unsigned((items + threads - 1) / threads); }

__global__ void __launch_bounds__(threads) count_in(const CellSearch search, const Vec3f* positions) {
    const uint32_t k = blockIdx.x * threads + threadIdx.x;
    if (k < search.count)
        search.count_in(k, positions[k],
                        [](uint32_t& shared, uint32_t more) { return atomicAdd(&shared, more); });
}
__global__ void __launch_bounds__(threads) arrive(const CellSearch search, const Vec3f* positions) {
    const uint32_t k = blockIdx.x * threads + threadIdx.x;
    if (k < search.count) search.arrive(k, positions[k]);
}
__global__ void __launch_bounds__(threads) settle(const CellSearch search) {
    const uint32_t k = blockIdx.x * threads + threadIdx.x;
    if (k < search.count) search.settle(k);
}

// In place: how many come before each cell.
cudaError_t scan(const CellSearch& v, void* memory, size_t& bytes, cudaStream_t stream) {
    return cub::DeviceScan::ExclusiveSum(memory, bytes, v.start, v.start, int(v.grid.cells() + 2), stream);
}

}  // namespace

CellSearchDevice::CellSearchDevice(size_t count, int particles, double radius, const Vec3f& origin)
    : particles_(particles),
      radius_(float(radius)),
      origin_(origin),
      grid_(wrapped_grid(count, radius)),
      rank_(count),
      start_(grid_.cells() + 2),
      sorted_id_(count),
      arrived_(count),
      sorted_(count + CellSearch::at_once - 1) {
    size_t bytes = 0;
    check_cuda(scan(view(), nullptr, bytes, nullptr), "size of the scan");
    scan_memory_ = DeviceBuffer<char>(bytes);
    check_cuda(cudaMemset(sorted_.data(), 0, sorted_.bytes()), "beyond the last");
    check_cuda(cudaStreamSynchronize(nullptr), "beyond the last");  // streams of launches do not wait for it
}

CellSearch CellSearchDevice::view() const {
    return {uint32_t(rank_.size()), particles_,     rank_.data(), start_.data(), arrived_.data(),
            sorted_id_.data(),      sorted_.data(), grid_,        origin_,       radius_};
}

void CellSearchDevice::launch(const Vec3f* positions, cudaStream_t stream) const {
    const CellSearch v = view();
    check_cuda(cudaMemsetAsync(v.start, 0, start_.bytes(), stream), "empty cells");
    count_in<<<blocks_for(v.count), threads, 0, stream>>>(v, positions);
    size_t bytes = scan_memory_.size();
    check_cuda(scan(v, scan_memory_.data(), bytes, stream), "scan");
    arrive<<<blocks_for(v.count), threads, 0, stream>>>(v, positions);
    settle<<<blocks_for(v.count), threads, 0, stream>>>(v);
    check_cuda(cudaGetLastError(), "launch of the search");
}

size_t CellSearchDevice::bytes() const {
    size_t sum = arrived_.bytes() + sorted_.bytes() + scan_memory_.bytes();
    for (const auto* b : {&rank_, &start_, &sorted_id_}) sum += b->bytes();
    return sum;
}

}  // namespace wetcurl
