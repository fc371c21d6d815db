// The frames of a simulation.
#include "app/engine/simulated_frames.h"

#include <fmt/format.h>

namespace wetcurl {

Diverged::Diverged(int frame, const Divergence& divergence)
    : Error(fmt::format("the run diverged at frame {}, strand {}, largest term '{}'; more [integrator] "
                        "substeps, or less stiffness, may help",
                        frame, divergence.strand, divergence.largest_term)) {}

bool SimulatedFrames::advance(bool shown) {
    if (index_ + 1 >= frames_) return false;
    // Nothing is computed for frame 0.
    if (++index_ > 0) simulation_.advance(shown);
    if (!shown) return true;
    if (const auto divergence = simulation_.divergence()) throw Diverged(index_, *divergence);
    return true;
}

}  // namespace wetcurl
