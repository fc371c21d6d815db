// The frames of a simulation.
#include "app/engine/simulated_frames.h"

#include <fmt/format.h>

#include "solver/chain/energies.h"

namespace wetcurl {

Diverged::Diverged(int frame, const Divergence& divergence)
    : Error(fmt::format("the run diverged at frame {}, strand {}, largest term '{}'; more [integrator] "
                        "substeps, or less stiffness, may help",
                        frame, divergence.strand, divergence.largest_term)) {}

Diverged::Diverged(const FrameExtreme& stretch, double allowed, const std::string& largest_term)
    : Error(fmt::format(
          "the run diverged at frame {}, strand {}, particle {}: found an edge of {:.3g} times its "
          "rest length, allowed are {:g} ([integrator] allow_stretch), largest term '{}'; more "
          "[integrator] substeps, or less stiffness, may help",
          stretch.frame, stretch.strand, stretch.particle, stretch.value, allowed, largest_term)) {}

void SimulatedFrames::finish(RunFrame& frame) {
    simulation_.finish_snapshot(frame);
    watch_.look(begun_, frame);
    const double allowed = simulation_.scene().integrator.allow_stretch;
    if (!(watch_.stretch()->value > allowed)) return;
    const std::vector<double> energy(frame.energy.begin(), frame.energy.end());
    throw Diverged(*watch_.stretch(), allowed, simulation_.energy_kinds[largest_energy(energy)]);
}

bool SimulatedFrames::advance(bool shown) {
    if (index_ + 1 >= frames_) return false;
    // Nothing is computed for frame 0.
    if (++index_ > 0) simulation_.advance(shown);
    if (!shown) return true;
    if (const auto divergence = simulation_.divergence()) throw Diverged(index_, *divergence);
    return true;
}

}  // namespace wetcurl
