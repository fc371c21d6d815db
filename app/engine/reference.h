// What runs of a scene are judged against: the same scene in double precision, in far shorter steps.
#pragma once

#include <memory>

#include "app/engine/simulated_frames.h"

namespace wetcurl {

class Reference {
  public:
    static constexpr int substeps = 160;  // a frame
    // On `device`, as of --device.
    explicit Reference(const Scene& scene, const std::string& device = "cpu");
    Reference(const Reference&) = delete;
    // The first call returns frame 0, each other one the frame after. Throws Error where it diverges.
    const RunFrame& next();

  private:
    Scene scene_;
    std::unique_ptr<Simulation> simulation_;
    SimulatedFrames frames_;
    RunFrame frame_;
};

// Mean distance of what is seen of the same strands [mm].
double distance_mm(const Strands& a, const Strands& b);

}  // namespace wetcurl
