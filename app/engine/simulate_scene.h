// A scene's whole simulation into a run file, with its results as JSON and a summary.
#pragma once

#include <optional>

#include "app/engine/run_start.h"
#include "app/files/results.h"
#include "solver/scene/scene.h"

namespace wetcurl {

struct SimulationRequest {
    std::string output;                 // run file
    std::string device, precision;      // as of SceneRun
    int threads;                        // of an adhesion network
    bool overwrite = false;             // an output that is there
    bool reference = false;             // also runs a Reference and reports the distance
    bool resume = false;                // goes on with what a broken run left at the output
    std::optional<RunStart> from = {};  // begins there, not at the scene's own frame 0
    bool keep_state = false;            // the state of the last frame stays in OUTPUT.state
};

// Simulates all frames of the scene. Throws Error where the simulation diverges and Interrupted after a
// signal; the frames so far are then in OUTPUT.partial, and a state to go on from in OUTPUT.state. Frames of
// a resumed run are those of an unbroken one to the bit; Error where the broken run was another one.
void simulate_scene(Scene scene, const SimulationRequest& request, ResultFile& results);

}  // namespace wetcurl
