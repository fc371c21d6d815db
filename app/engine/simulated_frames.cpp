// The frames of a simulation.
#include "app/engine/simulated_frames.h"

#include <fmt/format.h>

#include "solver/chain/energies.h"

namespace wetcurl {

// What may keep a run of the scene together.
static std::string remedies(const Scene& scene) {
    return std::string("more [integrator] substeps, ") +
           (scene.air ? "less stiffness, or in [air] a slower wind or less drag," : "or less stiffness,") +
           " may help";
}

Diverged::Diverged(const Scene& scene, int frame, const Divergence& divergence)
    : Error(fmt::format("the run diverged at frame {}, strand {}, largest term '{}'; {}", frame,
                        divergence.strand, divergence.largest_term, remedies(scene))) {}

Diverged::Diverged(const Scene& scene, const FrameExtreme& stretch, const std::string& where,
                   const std::string& largest_term)
    : Error(fmt::format(
          "the run diverged at frame {}, strand {}, particle {}: found an edge of {:.3g} times its "
          "rest length{}, allowed are {:g} ([integrator] allow_stretch), largest term '{}'; {}",
          stretch.frame, stretch.strand, stretch.particle, stretch.value, where,
          scene.integrator.allow_stretch, largest_term,
          where.empty()
              ? remedies(scene)
              : "that solid further from the roots may help, or attached = \"head\", in which hair lies "
                "as it is drawn")) {}

// The solid that lies over a strand's root at `time` [s], and so stretches the strand; "" where none does.
// What is attached to the head lets hair lie in it as it is drawn.
static std::string over_root(const Scene& scene, const RunFrame& frame, int strand, double time) {
    const Vec3d root = cast<double>(frame.positions.at(strand, 0));
    for (const Solid& solid : scene.solids) {
        if (solid.moves_with_roots() || solid.deformation) continue;
        const Vec3d in_solid = solid.at(time, frame.head).inverse(root);
        if (const double phi = distance(solid.shape, in_solid).phi; phi < 0)
            return fmt::format(", its root {:.3g} mm inside the solid '{}'", -1000 * phi, solid.name);
    }
    return "";
}

void require_bearable(const Simulation& simulation, const FrameWatch& watch, const RunFrame& frame,
                      double time) {
    const Scene& scene = simulation.scene();
    const FrameExtreme& longest = *watch.stretch();
    if (!(longest.value > scene.integrator.allow_stretch)) return;
    const std::vector<double> energy(frame.energy.begin(), frame.energy.end());
    throw Diverged(scene, longest, over_root(scene, frame, longest.strand, time),
                   simulation.energy_kinds[largest_energy(energy)]);
}

void SimulatedFrames::finish(RunFrame& frame) {
    simulation_.finish_snapshot(frame);
    watch_.look(begun_, frame);
    require_bearable(simulation_, watch_, frame, start_ + begun_ / simulation_.scene().fps);
}

bool SimulatedFrames::advance(bool shown) {
    if (index_ + 1 >= frames_) return false;
    // Nothing is computed for frame 0.
    if (++index_ > 0) simulation_.advance(shown);
    if (!shown) return true;
    if (const auto divergence = simulation_.divergence())
        throw Diverged(simulation_.scene(), index_, *divergence);
    return true;
}

}  // namespace wetcurl
