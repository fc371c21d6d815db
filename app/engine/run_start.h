// A run that begins at a frame of another one, perhaps of a changed scene.
#pragma once

#include <string>

#include "app/engine/scene_run.h"

namespace wetcurl {

struct RunStart {
    std::string file;
    RunHeader header;      // of that run
    int frame;             // of it
    RunFrame now, before;  // that frame, and the one before it, as far as there is one
    double time() const { return header.time(frame); }  // [s]
    std::string words() const;                          // "run.h5 frame 12"
};

// "RUN.h5@N", or "RUN.h5" for its last frame. Throws Misuse where the run has no such frame, Error as a
// RunReader.
RunStart run_start(const std::string& from);
// The scene's wetness becomes that of the frame, where both have one. Throws Error unless strands and
// particles are as many.
void take_wetness(Scene& scene, const RunStart& start);
// The simulation, which has not settled, goes to that frame: with the state that lies beside the run where it
// is of that frame, else at its positions, with velocities by the difference to the frame before. Says which.
void go_to(SceneRun& run, const RunStart& start);

}  // namespace wetcurl
