// Who is near whom, by the particles' positions of the moment: buffers and launches.
#pragma once

#include <cuda_runtime.h>

#include "base/device_buffer.h"
#include "cuda/device/cell_search.h"

namespace wetcurl {

// Nothing is allocated and nothing read by the host after construction, so that launches can be captured.
class CellSearchDevice {
  public:
    // Of `count` particles, `particles` a strand; `radius` [m]; `origin` of the cells: where hair is, since
    // far from it cells are no finer than floats.
    CellSearchDevice(size_t count, int particles, double radius, const Vec3f& origin);
    // Positions (strand, particle) -> what `view` is for.
    void launch(const Vec3f* positions, cudaStream_t stream) const;
    CellSearch view() const;
    size_t bytes() const;

  private:
    const int particles_;
    const float radius_;
    const Vec3f origin_;
    const WrappedGrid grid_;
    DeviceBuffer<uint32_t> rank_, start_, sorted_id_;
    DeviceBuffer<SortedPoint> arrived_, sorted_;
    DeviceBuffer<char> scan_memory_;
};

}  // namespace wetcurl
