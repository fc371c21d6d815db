// A scene's whole simulation into a run file, with its results as JSON and a summary.
#pragma once

#include "app/files/results.h"
#include "solver/scene/scene.h"

namespace wetcurl {

struct SimulationRequest {
    std::string output;             // run file
    std::string device, precision;  // as of SceneRun
    int threads;                    // of an adhesion network
    bool overwrite = false;         // an output that is there
    bool reference = false;         // also runs a Reference and reports the distance
};

// Simulates all frames of the scene. Throws Error where the simulation diverges and Interrupted after a
// signal; the frames so far are then in OUTPUT.partial.
void simulate_scene(Scene scene, const SimulationRequest& request, ResultFile& results);

}  // namespace wetcurl
