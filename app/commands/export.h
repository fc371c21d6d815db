// `wetcurl export`: a run's strands for other programs.
#pragma once

#include "app/options/common_options.h"

namespace wetcurl {

struct ExportOptions : CommonOptions {
    static constexpr const char *command = "export",
                                *summary = "write a run's animated strands for other programs";
    static constexpr bool reads_scene = false, uses_device = false;
    std::string run, output;
    std::string solids;                   // a file for head and solids; "": none
    std::string positions = "displayed";  // displayed | simulated
    std::string target;                   // blender | houdini | maya | unreal; "": none of them
    std::string frames;                   // "A" or "A:B"; "": all
    int every = 1;                        // every so many frames
    int first_number = 1;                 // of the run's frame 0, in the file
    int resample = 0;                     // points a strand; 0: the run's
    int guides = 0;                       // strands that are animated; 0: all
    double width = 0;  // diameter [m]; 0: the file's that a strand came from, else the scene's
};

void add_options(OptionList& options, ExportOptions& o);
int export_command(const ExportOptions& o);

}  // namespace wetcurl
