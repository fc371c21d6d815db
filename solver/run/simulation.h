// A running simulation: what the scene names, stepped frame by frame.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/carried.h"
#include "base/run_cache.h"
#include "solver/adhesion/adhesion_network_coupling.h"
#include "solver/chain/work_meter.h"
#include "solver/scene/scene.h"
#include "solver/water/flow_pass.h"

namespace wetcurl {

// All that a simulation goes on from, in double whatever it is kept in; arrays (strand, particle). Another
// simulation may take it over: one of the same strands with another step, another mass or other terms.
struct SimulationState : StateArrays<double, HostArray> {
    double time = 0;
    bool first = true;  // no history: the next substep is backward Euler
    std::vector<double>
        saturation;  // empty without flow; a simulation that takes it over counts its water anew
};

// All that a run goes on from to the same bits: what a SimulationState lacks is what stages that act on all
// strands carry from frame to frame, and counts. For a simulation of the same scene, precision and device.
struct RunState : SimulationState {
    Carried carried;
};

class Simulation {
  public:
    virtual ~Simulation() = default;
    virtual const Scene& scene() const = 0;
    // One frame: the substeps, then the displayed positions. Where a frame is not `shown`, and nothing in the
    // scene reads them, these stay as they were, and a snapshot or `divergence` may be of the last one shown.
    virtual void advance(bool shown = true) = 0;
    // A frame of another length than the scene's, in substeps no longer than the scene's.
    virtual void advance_by(double seconds) = 0;
    // [s] that are simulated.
    virtual double time() const = 0;
    // What moves stands elsewhere at once, where `move` puts it; the hair begins anew there, each strand at
    // its root.
    virtual void cut(const std::function<void()>& move) = 0;
    // (strand, particle) [m/s] of the simulated positions.
    virtual std::vector<Vec3f> velocities() const = 0;
    // The state as it is; `frame` is filled whole.
    void snapshot(RunFrame& frame) { begin_snapshot(frame), finish_snapshot(frame); }
    // The same in two halves: the second may wait for what comes from a device, on another thread, while the
    // next frame is computed. One frame at a time.
    virtual void begin_snapshot(RunFrame& frame) = 0;
    virtual void finish_snapshot(RunFrame& frame) const = 0;
    // The first strand that is not finite or has left the scene (ten strand lengths from its root).
    virtual std::optional<Divergence> divergence() const = 0;
    virtual BufferList buffers() const = 0;
    virtual double neighbours_mean() const = 0;
    // Where a device keeps the positions (strand, particle) [m] of the frame shown last, the same place as
    // long as the simulation lives: whoever reads them there must be through when the next frame begins.
    // null: on the CPU.
    virtual const Vec3f* positions_on_device() const { return nullptr; }
    virtual long limited_edges() const = 0;  // by the strain limiter, so far
    virtual void use_adhesion_predictor(AdhesionPredictor* model) = 0;
    // Of the flow, where the scene has one.
    virtual std::optional<WaterBalance> water() const { return std::nullopt; }
    // From now on every substep's particles near solids are appended to `records` (null: stop).
    virtual void record_adhesion(std::vector<AdhesionRecord>* records) = 0;
    virtual SimulationState state() const = 0;
    // What `state` leaves empty, or holds for what this scene does not name, stays as it is.
    virtual void restore(const SimulationState&) = 0;
    // (strand, particle) from now on, in a scene with [wetness.flow].
    virtual void wet(const std::vector<double>& saturation) = 0;
    // Between two frames.
    virtual RunState run_state() const = 0;
    virtual void resume(const RunState&) = 0;
    // From now on the work done on the hair is counted; it costs some time. Throw Error on a GPU, which
    // counts none.
    virtual void count_work() = 0;
    virtual Work work() const = 0;
    // [J] of each kind, in double.
    virtual std::vector<double> energy() const = 0;

    std::vector<std::string> energy_kinds;  // columns of RunFrame::energy
    std::vector<std::string> stages;        // columns of RunFrame::stage_seconds
};

// `precision`: "float" or "double". The scene must outlive the simulation.
std::unique_ptr<Simulation> make_simulation(const Scene& scene, const std::string& precision);
std::unique_ptr<Simulation> make_simulation(Scene&&, const std::string&) = delete;

}  // namespace wetcurl
