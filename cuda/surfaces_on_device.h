// The level sets of a scene's deforming solids in a device's memory, a schedule's Surfaces. Ours.
#pragma once

#include "cuda/driver.h"
#include "cuda/level_set_kernel.h"
#include "solver/deforming_solids.h"

namespace wetcurl {

// All is queued on the hair's stream, before its substeps.
class SurfacesOnDevice : public DeformingSolidsOf<MovingLevelSetDevice> {
  public:
    template <class Hair>
    SurfacesOnDevice(const Scene& scene, const Hair& hair)
        : DeformingSolidsOf(scene, hair.stream()), stream_(hair.stream()) {}

    void advance(double from, double to, int substeps) {
        begin_.record(stream_);
        DeformingSolidsOf::advance(from, to, substeps);
        end_.record(stream_);
    }
    // With what the stream waits for the host's trees.
    void finish() { seconds = end_.since(begin_); }

  private:
    const cudaStream_t stream_;
    Event begin_, end_;
};

}  // namespace wetcurl
