// `wetcurl bench`: times of the parts of the program.
#pragma once

#include "app/options/common_options.h"

namespace wetcurl {

struct BenchOptions : CommonOptions {
    static constexpr const char *command = "bench",
                                *summary = "measure the parts of the program on this machine";
    static constexpr bool reads_scene = false;
    std::string filter;
    std::vector<std::string> models;  // whose frames are timed too
};

void add_options(OptionList& options, BenchOptions& o);
int bench_command(const BenchOptions& o);

}  // namespace wetcurl
