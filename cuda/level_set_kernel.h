// The level set of a moving mesh in a device's memory, as MovingLevelSet: the host finds the tree of its
// triangles, the device rebuilds its nodes. Ours.
#pragma once

#include <algorithm>
#include <span>

#include "base/device_buffer.h"
#include "base/geometry/moving_level_set.h"

namespace wetcurl {

// An array that the host sends anew each time, by way of page-locked memory.
template <class V>
struct SentBuffer {
    explicit SentBuffer(size_t most) : staged(most), device(most) {}
    // On a stream that is through with what was sent before.
    std::span<const V> send(std::span<const V> values, cudaStream_t stream) {
        std::copy(values.begin(), values.end(), staged.data());
        check_cuda(cudaMemcpyAsync(device.data(), staged.data(), values.size_bytes(), cudaMemcpyHostToDevice,
                                   stream),
                   "upload");
        return {device.data(), values.size()};
    }
    PinnedBuffer<V> staged;
    DeviceBuffer<V> device;
};

class MovingLevelSetDevice {
  public:
    // As a MovingLevelSet. All is queued on `stream`.
    MovingLevelSetDevice(const Mesh& mesh, const Bounds& box, double spacing, double band,
                         cudaStream_t stream);

    // As MovingLevelSet's, of a stream that has come past the last one.
    void advance(const std::vector<Vec3f>& vertices, double seconds);
    void hold(const std::vector<Vec3f>& vertices);

    // In the device's memory. Valid until the next advance or hold.
    MovingGrid grid(double share) const;
    size_t nodes() const { return phi_.size(); }
    size_t bytes() const;

  private:
    void build(const DeviceBuffer<Vec3f>& before);

    const cudaStream_t stream_;
    Mesh mesh_;
    const NarrowBand band_;
    double per_second_ = 0;
    SentBuffer<TriangleTree::Triangle> triangles_;
    SentBuffer<int> original_, place_;
    SentBuffer<TriangleTree::Node> tree_nodes_;
    SentBuffer<Vec3f> vertices_;
    DeviceBuffer<Vec3f> before_;
    const DeviceBuffer<std::array<int, 3>> corners_;
    DeviceBuffer<float> phi_before_, phi_;  // (nz, ny, nx), as those that follow
    DeviceBuffer<Vec3f> velocity_;
    DeviceBuffer<int> triangle_;
};

}  // namespace wetcurl
