// The level set of a moving mesh in a device's memory, as MovingLevelSet: the host finds the tree of its
// triangles, the device rebuilds its nodes.
#pragma once

#include <algorithm>
#include <span>

#include "base/device_buffer.h"
#include "base/geometry/moving_level_set.h"

namespace wetcurl {

// An array that the host fills anew each time, in page-locked memory, and sends.
template <class V>
struct SentBuffer {
    explicit SentBuffer(size_t most) : staged(most), device(most) {}
    // Once what was sent before has come through.
    void fill(std::span<const V> values) { std::copy(values.begin(), values.end(), staged.data()); }
    // All that there is room for, so that the launch is the same each time.
    void send(cudaStream_t stream) const {
        check_cuda(
            cudaMemcpyAsync(device.data(), staged.data(), device.bytes(), cudaMemcpyHostToDevice, stream),
            "upload");
    }
    std::span<const V> sent() const { return {device.data(), device.size()}; }
    PinnedBuffer<V> staged;
    DeviceBuffer<V> device;
};

class MovingLevelSetDevice {
  public:
    // As a MovingLevelSet. What it launches by itself is queued on `stream`.
    MovingLevelSetDevice(const Mesh& mesh, const Bounds& box, double spacing, double band,
                         cudaStream_t stream);

    // As MovingLevelSet's, of a stream that has come past the last one. The host's part alone: the device's
    // are the launches that follow, the same for any span of as many seconds.
    void advance(const std::vector<Vec3f>& vertices, double seconds);
    void launch_advance(cudaStream_t stream) const;
    void hold(const std::vector<Vec3f>& vertices);

    // In the device's memory, which stays where it is.
    MovingGrid grid(double share) const;
    size_t nodes() const { return phi_.size(); }
    size_t bytes() const;

  private:
    void find_tree(const std::vector<Vec3f>& vertices);
    void send(cudaStream_t stream) const;
    void launch_rebuild(cudaStream_t stream) const;

    const cudaStream_t stream_;
    Mesh mesh_;
    MeshDistance surface_;  // its
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
