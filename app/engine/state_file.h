// What a broken run goes on from: NAME.h5.state beside NAME.h5.partial, which `simulate --resume` reads.
// HDF5 "wetcurl state"; docs/files.md describes it.
#pragma once

#include <optional>
#include <string>

#include "base/run_cache.h"
#include "solver/run/simulation.h"

namespace wetcurl {

// What the state of one run and another must agree in, beside the header of their files.
struct StateFacts {
    std::string run;        // hash of the run's scene and strands
    std::string precision;  // "float" or "double"
    std::string device;
};
StateFacts facts_of(const RunHeader& header, const std::string& precision);

struct StoredState {
    int frame;
    StateFacts facts;
    RunState state;
};

// Where the states of the run of that output lie.
std::string state_file_of(const std::string& output);
// The frame of the state in that file; none where no file is there. Throws Error where it is damaged.
std::optional<int> frame_of_state(const std::string& file);
// Arrays as `like` has them, a state of the simulation that is to go on. Throws Error where the file is not
// there or damaged, or, if `exactly`, where its arrays are others; if not, those that are not alike stay as
// in `like`.
StoredState read_state(const std::string& file, const RunState& like, bool exactly);

// Keeps the state of a run on disk, the last one that was written whole: at frame 0, then so seldom that it
// costs half a percent of the run's time, and when the run is stopped.
class StateKeeper {
  public:
    // A state that an earlier run left there goes, unless `kept`.
    StateKeeper(const std::string& output, StateFacts facts, bool kept);
    // Takes the state of frame `frame`, at which the simulation is, where one is due.
    void offer(int frame, const Simulation& simulation);
    // Writes what was taken; its frame must be in the run.
    void write();
    // Both, of the last frame of a run that is stopped.
    void leave(int frame, const Simulation& simulation);
    // The run is whole: nothing goes on from here.
    void remove();

  private:
    void take(int frame, const Simulation& simulation);

    std::string file_;
    StateFacts facts_;
    std::optional<StoredState> taken_;
    double cost_ = 0, due_ = 0;  // [s] of the state at hand; when the next one is due
};

}  // namespace wetcurl
