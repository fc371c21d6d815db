// The level sets of a scene's deforming solids in a device's memory, the frame loop's surfaces.
#pragma once

#include "cuda/device/cuda_owners.h"
#include "cuda/solids/level_set_kernel.h"
#include "solver/solids/deforming_solids.h"

namespace wetcurl {

class DeformingSolidsOnDevice : public DeformingSolidsOf<MovingLevelSetDevice> {
  public:
    template <class H>
    DeformingSolidsOnDevice(const Scene& scene, const H& hair) : DeformingSolidsOf(scene, hair.stream()) {}

    // The host finds the trees; the rest is queued for the hair's frame.
    template <class H>
    void advance(H& hair, double begin, double span, int substeps) {
        DeformingSolidsOf::advance(hair, begin, span, substeps);
        hair.queue([this](cudaStream_t stream) {
            begin_.record(stream);
            for (const auto& level_set : level_sets()) level_set.launch_advance(stream);
            end_.record(stream);
        });
    }
    void finish() { seconds += end_.since(begin_); }

  private:
    Event begin_, end_;
};

}  // namespace wetcurl
