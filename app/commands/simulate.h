// `wetcurl simulate`: the physics of a scene, into a run.
#pragma once

#include "app/options/common_options.h"

namespace wetcurl {

struct SimulateOptions : CommonOptions {
    static constexpr const char *command = "simulate",
                                *summary = "run the physics of a scene into a run cache";
    std::string scene, output;
    std::optional<int> frames, strands, guides;
    std::string groom;
    std::string precision = "float";
    bool dry = false;
    bool before_cohesion = false;  // without Eq 10, which moves what is displayed alone
    std::string from;              // RUN.h5@N: begin at frame N of that run
    bool keep_state = false;       // leave OUTPUT.state of the last frame
    bool reference = false;        // also run in double with 160 substeps and report the error
};

void add_options(OptionList& options, SimulateOptions& o);
int simulate_command(const SimulateOptions& o);

}  // namespace wetcurl
