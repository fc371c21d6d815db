// `wetcurl render`: pictures and films.
#pragma once

#include "app/drawing/picture.h"
#include "app/options/common_options.h"

namespace wetcurl {

struct RenderOptions : CommonOptions {
    static constexpr const char *command = "render",
                                *summary = "draw runs, or geometry images, side by side, without a window";
    static constexpr bool reads_scene = false, uses_device = false, writes_json = false;
    std::vector<std::string> runs;  // side by side; with `image` pairs and models too
    std::string output;
    int frame = -1;      // -1: all of them (video), or the last one (picture)
    bool image = false;  // geometry images in place of strands
    int run = 0;         // of a pairs file, for `image`
    int pixels = 400;    // a panel's least side, for `image`
    int width = 720, height = 900;
    bool saturation = false, expected_error = false;  // what strands are coloured by
    View view;                                        // of the camera around the head
    bool follow = false;                              // the camera moves with the head
    std::vector<double>
        light;  // yaw and pitch of the key light, from the camera [degrees]; empty: as a Panel has it
    bool labels = true;
    std::vector<std::string> label;  // of each run, in place of its method; none: the methods
};

void add_options(OptionList& options, RenderOptions& o);
int render_command(const RenderOptions& o);

}  // namespace wetcurl
