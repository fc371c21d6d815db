// `wetcurl encode`: training pairs of runs.
#pragma once

#include "app/options/common_options.h"

namespace CLI {
class App;
}

namespace wetcurl {

struct EncodeOptions : CommonOptions {
    static constexpr const char *command = "encode",
                                *summary =
                                    "make training pairs of dry low-resolution and wet high-resolution runs";
    static constexpr bool uses_device = false;
    std::vector<std::string> inputs;  // DRY.h5 WET.h5 pairs, or wet runs for adhesion samples
    std::string output, codec = "strand";
    std::string colour_units;  // of Eq 16, codec root; "": length
};

void add_options(CLI::App& app, EncodeOptions& o);
int encode_command(const EncodeOptions& o);

}  // namespace wetcurl
