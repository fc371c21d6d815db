// The displayed positions on a device: lists, Jacobi passes, projection.
#pragma once

#include <cuda_runtime.h>

#include "base/device_buffer.h"
#include "cuda/chain/strand_memory.h"
#include "cuda/cohesion/cohesion_kernel_body.h"
#include "cuda/device/cell_search_device.h"
#include "cuda/device/cuda_owners.h"

namespace wetcurl {

// What a frame leaves for the host to read when it is done.
struct FrameReport {
    int diverged = 0x7fffffff;  // first strand that has, if any
    unsigned long long pairs = 0, limited = 0;
    unsigned long long pulled = 0, touching = 0;  // pairs of the last substep's forces and contacts
    unsigned long long list_rows = 0;             // of 32 lanes by 4 ranks that neighbour lists ask for
};

// The report of the frame at hand on the device, and of the last one that came back.
class FrameReports {
  public:
    FrameReports() { blank_[0] = on_both_.host[0] = {}; }
    FrameReport* data() const { return on_both_.device.data(); }
    void clear(cudaStream_t stream) const {
        check_cuda(
            cudaMemcpyAsync(data(), blank_.data(), sizeof(FrameReport), cudaMemcpyHostToDevice, stream),
            "report");
    }
    void fetch(cudaStream_t stream) { on_both_.fetch(stream); }
    const FrameReport& last() const { return on_both_.host[0]; }

  private:
    PinnedBuffer<FrameReport> blank_{1};
    OnBoth<FrameReport> on_both_{1};
};

// Buffers and launches for one scene. Nothing is allocated and nothing read by the host between two calls of
// `grow`, so that launches can be captured into a graph.
class CohesionDevice {
  public:
    // `thinning`: of whom Eq 10 is asked. `origin`: where the head is when the run begins. V [m^3], sigma and
    // `rest_depth` [m] (strand, particle), the last or empty. `flows`: others change the sigma; all are
    // asked.
    CohesionDevice(const Cohesion& term, int strands, const Thinning& thinning, const Vec3f& origin,
                   const std::vector<float>& volume, const std::vector<float>& saturation, bool flows,
                   const std::vector<float>& rest_depth);
    // Where they lie, V and sigma V, for water that changes them.
    float* volumes() const { return volume_.data(); }
    float* wet_volumes() const { return wet_volume_.data(); }
    // How many are asked.
    size_t asked() const { return volume_.size(); }

    // Positions (strand, particle) -> neighbour lists.
    void launch_lists(const Vec3f* positions, FrameReport* report, cudaStream_t stream);
    // -> displayed positions, pushed out of the motion's solids and led around them.
    template <class T>
    void launch_passes(const Vec3f* simulated, const SubstepMotion<T>* motion, Vec3f* displayed,
                       cudaStream_t stream);
    // Makes room for lists as long as a frame's report says; false where there was.
    bool grow(const FrameReport& report);

    size_t bytes() const;

  private:
    CohesionKernelBody bodies() const;
    Cohesion term_;
    Thinning thinning_;
    int strands_, strands_of_block_, shown_of_block_, threads_, threads_a_list_;
    unsigned blocks_;
    int staged_;  // entries of each list while they are made
    size_t shared_bytes_;
    bool keeps_;  // what strands that move read
    CellSearchDevice search_;
    DeviceBuffer<float> volume_, wet_volume_,
        own_volume_;                  // (strand, particle that is asked), the last or empty
    DeviceBuffer<float> rest_depth_;  // (strand, particle)
    DeviceBuffer<Vec3f> thinned_;     // (strand, particle that is asked), or empty
    // As CohesionMemory says.
    DeviceBuffer<HairPoint> point_;
    DeviceBuffer<float> sorted_wet_volume_;
    DeviceBuffer<uint8_t> wet_cell_;
    DeviceBuffer<uint8_t> who_;
    DeviceBuffer<ListGroup> group_;
    DeviceBuffer<Ranks<4>> list_;
    DeviceBuffer<Displaced> displaced_;
    DeviceBuffer<float> beta_, own_weight_, self_weight_;
};

}  // namespace wetcurl
