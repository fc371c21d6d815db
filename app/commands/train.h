// `wetcurl train`: training of a network.
#pragma once

#include "app/options/common_options.h"

namespace CLI {
class App;
}

namespace wetcurl {

struct TrainOptions : CommonOptions {
    static constexpr const char *command = "train", *summary = "train a network on pairs";
    std::string kind;  // sr | adhesion
    std::vector<std::string> pairs, validation;
    std::string output, recipe, architecture, from;
    std::optional<double> width;
};

void add_options(CLI::App& app, TrainOptions& o);
int train_command(const TrainOptions& o);

}  // namespace wetcurl
