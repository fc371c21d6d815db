// Kernels of the search, and the sort between them.
#include <cub/device/device_radix_sort.cuh>

#include "cuda/cell_search_device.h"

namespace wetcurl {

namespace {

constexpr unsigned threads = 128;

unsigned blocks_for(size_t items) { return unsigned((items + threads - 1) / threads); }

// A thread a cell: there are as many as particles, or more.
__global__ void __launch_bounds__(threads) place(const CellSearch search, const Vec3f* positions) {
    const uint32_t k = blockIdx.x * threads + threadIdx.x;
    if (k < search.grid.cells()) search.empty_cell(k);
    if (k < search.count) search.place(k, positions[k]);
}
__global__ void __launch_bounds__(threads) mark_cells(const CellSearch search, const Vec3f* positions) {
    const uint32_t k = blockIdx.x * threads + threadIdx.x;
    if (k < search.count) search.mark_cell(k, positions[search.sorted_id[k]]);
}

// By the bits that a cell's number has and one more: the key of what lies in none.
cudaError_t sort(const CellSearch& v, void* memory, size_t& bytes, cudaStream_t stream) {
    const int bits = v.grid.bits_x + v.grid.bits_y + v.grid.bits_z + 1;
    return cub::DeviceRadixSort::SortPairs(memory, bytes, v.key, v.sorted_key, v.id, v.sorted_id,
                                           int(v.count), 0, bits, stream);
}

}  // namespace

CellSearchDevice::CellSearchDevice(size_t count, int particles, double radius, const Vec3f& origin)
    : particles_(particles),
      radius_(float(radius)),
      origin_(origin),
      grid_(wrapped_grid(count, radius)),
      key_(count),
      id_(count),
      sorted_key_(count),
      sorted_id_(count),
      sorted_(count + CellSearch::at_once - 1),
      cell_(grid_.cells()) {
    size_t bytes = 0;
    check_cuda(sort(view(), nullptr, bytes, nullptr), "size of the sort");
    sort_memory_ = DeviceBuffer<char>(bytes);
    check_cuda(cudaMemset(sorted_.data(), 0, sorted_.bytes()), "beyond the last");
    check_cuda(cudaStreamSynchronize(nullptr), "beyond the last");  // streams of launches do not wait for it
}

CellSearch CellSearchDevice::view() const {
    return {uint32_t(key_.size()),
            particles_,
            key_.data(),
            id_.data(),
            sorted_key_.data(),
            sorted_id_.data(),
            sorted_.data(),
            cell_.data(),
            grid_,
            origin_,
            radius_};
}

void CellSearchDevice::launch(const Vec3f* positions, cudaStream_t stream) const {
    const CellSearch v = view();
    place<<<blocks_for(grid_.cells()), threads, 0, stream>>>(v, positions);
    size_t bytes = sort_memory_.size();
    check_cuda(sort(v, sort_memory_.data(), bytes, stream), "sort");
    mark_cells<<<blocks_for(v.count), threads, 0, stream>>>(v, positions);
    check_cuda(cudaGetLastError(), "launch of the search");
}

size_t CellSearchDevice::bytes() const {
    size_t sum = sorted_.bytes() + cell_.bytes() + sort_memory_.bytes();
    for (const auto* b : {&key_, &id_, &sorted_key_, &sorted_id_}) sum += b->bytes();
    return sum;
}

}  // namespace wetcurl
