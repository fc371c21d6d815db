// `wetcurl retrain`: a network and all that it is made of, as one recipe says.
#pragma once

#include "app/options/common_options.h"

namespace wetcurl {

struct RetrainOptions : CommonOptions {
    static constexpr const char *command = "retrain",
                                *summary = "make a data set and train a network on it, as its recipe says";
    std::string recipe, output, part;  // part: "K/N"
    std::string scene, from;           // in place of the data set's scene and of the recipe's network
};

void add_options(OptionList& options, RetrainOptions& o);
int retrain_command(const RetrainOptions& o);

}  // namespace wetcurl
