// `wetcurl compare`: errors and run times of runs against a reference.
#pragma once

#include "app/options/common_options.h"

namespace wetcurl {

struct CompareOptions : CommonOptions {
    static constexpr const char *command = "compare",
                                *summary = "error and run time of runs against a reference";
    static constexpr bool reads_scene = false, uses_device = false;
    std::string reference;
    std::vector<std::string> others;
    int first_frame = 0;  // frames before this one are left out (those that training saw)
};

void add_options(OptionList& options, CompareOptions& o);
int compare_command(const CompareOptions& o);
std::string compare_columns();  // what the columns of its table mean, a line each

}  // namespace wetcurl
