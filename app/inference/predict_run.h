// A whole low-resolution run to predicted strands in a run file, with results as JSON and a summary.
#pragma once

#include "app/files/results.h"
#include "app/inference/low_run.h"

namespace wetcurl {

struct PredictionRequest {
    std::string output;  // run file
    int frames;          // the first so many of the run
    std::string device;  // as of --device
    int threads;
    bool overwrite = false;  // an output that is there
    bool resume = false;     // goes on with what a broken run left at the output
    double within = 0;  // [m] strands that are expected to be off by more are simulated; with `again` alone
    LowRun* again = nullptr;  // the low-resolution run a second time, to see first which these are
};

// `scene`: at the resolution to predict; it was read from `scene_file`. Throws Misuse where the method does
// not go with the run or the scene, Error where files do not fit or positions are not finite, Interrupted
// after a signal; the frames so far are then in OUTPUT.partial.
void predict_run(const Method& method, Scene scene, const std::string& scene_file, LowRun& low,
                 const PredictionRequest& request, ResultFile& results);

}  // namespace wetcurl
