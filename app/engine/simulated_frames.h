// The frames of a simulation, computed as they are asked for: the one place where the program advances a
// simulation.
#pragma once

#include "base/error.h"
#include "base/frames.h"
#include "solver/run/simulation.h"

namespace wetcurl {

// A strand is not finite any more, or has left the scene.
class Diverged : public Error {
  public:
    Diverged(int frame, const Divergence& divergence);
};

class SimulatedFrames final : public FrameSource {
  public:
    // At most `frames`, of which frame 0 is the state at time 0. The simulation must outlive this.
    SimulatedFrames(Simulation& simulation, int frames) : simulation_(simulation), frames_(frames) {}
    // Throws Diverged.
    bool advance() override { return advance(true); }
    // A frame that is not `shown` may be neither filled in nor checked.
    bool advance(bool shown);
    void begin(RunFrame& frame) override { simulation_.begin_snapshot(frame); }
    void finish(RunFrame& frame) override { simulation_.finish_snapshot(frame); }
    // Of the frame at hand; -1 before the first.
    int index() const { return index_; }

  private:
    Simulation& simulation_;
    int frames_, index_ = -1;
};

}  // namespace wetcurl
