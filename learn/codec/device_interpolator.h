// Interpolation without a network on a CUDA device: what learn/codec/interpolate.h does, with strands of both
// resolutions in the device's memory.
#pragma once

#include <optional>

#include "learn/codec/interpolation.h"
#include "learn/codec/stencil.h"
#include "learn/codec/strand_kernels.h"

namespace wetcurl {

class DeviceInterpolator {
  public:
    // On the current device; as of Interpolator. Throws Error for `rest` with another stencil than
    // quad_stencil.
    DeviceInterpolator(Interpolation kind, const Stencil& stencil, const Groom& high, const Groom& low,
                       const Strands* shape = nullptr, bool low_is_wet = false,
                       const Settled* settled = nullptr);

    int low_strands() const { return low_; }
    int high_strands() const { return high_; }
    int particles() const { return n_; }
    // low (low strands, particles), out (high strands, particles): world positions on the device [m]; `head`:
    // the pose of the frame. What was asked for before must be through.
    void apply(const Vec3f* low, const Pose& head, Vec3f* out, cudaStream_t stream);

  private:
    Interpolation kind_;
    int n_, low_, high_, width_;
    std::optional<StrandKernels> rest_;  // used by `rest` alone, which uses nothing else
    DeviceBuffer<Vec3f> root_;           // (high) in the head's frame
    DeviceBuffer<int> from_, nearest_;
    DeviceBuffer<float> weight_;
    DeviceBuffer<Vec3f> cores_;  // (low, n), used by `core` alone
};

}  // namespace wetcurl
