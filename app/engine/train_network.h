// Training of a network on pairs files.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/options/common_options.h"

namespace wetcurl {

struct TrainingRequest : CommonOptions {
    std::string kind;  // sr | adhesion
    std::vector<std::string> pairs, validation;
    std::string output, recipe, architecture, from;
    std::optional<double> width;
};

// Trains it, into the model `output`, and tells of it as JSON where `json` asks for that, else in a line.
// Throws Misuse for a wrong recipe, Error for pairs that do not fit, and Interrupted after a signal.
void train_network(const TrainingRequest& request);

}  // namespace wetcurl
