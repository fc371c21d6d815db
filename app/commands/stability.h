// `wetcurl stability`: the battery of stability.
#pragma once

#include "app/options/common_options.h"

namespace wetcurl {

struct StabilityCommandOptions : CommonOptions {
    static constexpr const char *command = "stability",
                                *summary = "put ways of stepping through the battery of stability, S1 to S10";
    static constexpr bool uses_device = false;
    std::string scene;                       // of S9; "": one of our own
    std::vector<std::string> methods, only;  // by name, cases by id; none: all
    bool quick = false;
    int storm = 0;  // so many random scenes in place of the battery
};

void add_options(OptionList& options, StabilityCommandOptions& o);
int stability_command(const StabilityCommandOptions& o);

}  // namespace wetcurl
