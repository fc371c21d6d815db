// What is seen of wet hair, computed on a CUDA device: solver/cohesion/display.h of strands that lie there.
#pragma once

#include <memory>

#include "base/device_stream.h"
#include "solver/scene/scene.h"

namespace wetcurl {

class DeviceDisplay {
  public:
    virtual ~DeviceDisplay() = default;
    // Where `apply` reads the strands, (strand, particle) world [m], in the device's memory.
    virtual Vec3f* strands() = 0;
    // displayed (strand, particle), in the device's memory too, becomes p^w of `strands` at a pose of the
    // head and a time [s]. Who writes these must be through, or write on the stream `after`. Returns when it
    // is there. Nothing is allocated but for neighbour lists longer than ever before.
    virtual void apply(Vec3f* displayed, const Pose& head, double time, DeviceStream after = nullptr) = 0;
    // The same of strands in the host's memory.
    virtual void apply(Strands& p, const Pose& head, double time) = 0;
    virtual double neighbours_mean() const = 0;
};

// For a scene with [cohesion] whose solids are rigid; it must outlive the display. `device` counts from 0.
// Throws Error where there is no such device, or a solid deforms.
std::unique_ptr<DeviceDisplay> make_cuda_display(const Scene& scene, int device);

}  // namespace wetcurl
