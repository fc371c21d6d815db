// The frames of a simulation, computed as they are asked for: the one place where the program advances a
// simulation.
#pragma once

#include "base/error.h"
#include "base/frame_watch.h"
#include "base/frames.h"
#include "solver/run/simulation.h"

namespace wetcurl {

// A strand is not finite any more, has left the scene, or has an edge far beyond its rest length.
class Diverged : public Error {
  public:
    Diverged(const Scene& scene, int frame, const Divergence& divergence);
    // `where`: what its root lies in, or ""; of all strands together the term of most energy.
    Diverged(const Scene& scene, const FrameExtreme& stretch, const std::string& where,
             const std::string& largest_term);
};

// Throws Diverged where the longest edge that was looked at is longer than the scene allows; `frame` is the
// last one, at `time` [s].
void require_bearable(const Simulation& simulation, const FrameWatch& watch, const RunFrame& frame,
                      double time);

class SimulatedFrames final : public FrameSource {
  public:
    // At most `frames`, of which frame 0 is the state at time `start` [s]; `at`: the frame that the
    // simulation shows already, -1: it shows frame 0, which comes first. The simulation must outlive this.
    SimulatedFrames(Simulation& simulation, int frames, int at = -1, double start = 0)
        : simulation_(simulation),
          frames_(frames),
          start_(start),
          index_(at),
          watch_(simulation.scene().groom, simulation.scene().fps) {}
    // Throws Diverged.
    bool advance() override { return advance(true); }
    // A frame that is not `shown` may be neither filled in nor checked.
    bool advance(bool shown);
    void begin(RunFrame& frame) override {
        begun_ = index_;
        simulation_.begin_snapshot(frame);
    }
    // Throws Diverged where an edge is longer than the scene allows.
    void finish(RunFrame& frame) override;
    // Of the frame at hand; -1 before the first.
    int index() const { return index_; }
    // Of the frames that were filled in; others may be shown to it before them.
    FrameWatch& watch() { return watch_; }

  private:
    Simulation& simulation_;
    int frames_;
    double start_;  // [s]
    int index_, begun_ = -1;
    FrameWatch watch_;
};

}  // namespace wetcurl
