// `wetcurl inspect`: what a file holds, and what a scene may say.
#pragma once

#include "app/options/common_options.h"

namespace wetcurl {

struct InspectOptions : CommonOptions {
    static constexpr const char
        *command = "inspect",
        *summary = "say what a file holds, what a scene names and leaves out, or what it may say";
    static constexpr bool uses_device = false;
    std::string what, file;  // scene | run | pairs | model | keys | schema | device
    std::string output;      // allowed for none: render draws
};

void add_options(OptionList& options, InspectOptions& o);
int inspect_command(const InspectOptions& o);

}  // namespace wetcurl
