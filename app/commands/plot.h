// `wetcurl plot`: charts.
#pragma once

#include "app/options/common_options.h"

namespace wetcurl {

struct PlotOptions : CommonOptions {
    static constexpr const char *
        command = "plot",
       *summary =
           "draw the energy of runs or the time of their frames, the loss of trainings, an adhesion network, "
           "or charts, side by side";
    static constexpr bool reads_scene = false, uses_device = false, writes_json = false;
    std::vector<std::string> runs;  // side by side: runs, logs of trainings, or one pairs file
    std::string model;              // for pairs of codec adhesion
    bool time = false;              // of runs: the time of each frame in place of energy
    std::string output;
    int width = 720, height = 480;
};

void add_options(OptionList& options, PlotOptions& o);
int plot_command(const PlotOptions& o);

}  // namespace wetcurl
