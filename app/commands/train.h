// `wetcurl train`: training of a network.
#pragma once

#include "app/engine/train_network.h"

namespace CLI {
class App;
}

namespace wetcurl {

struct TrainOptions : TrainingRequest {
    static constexpr const char *command = "train", *summary = "train a network on pairs";
};

void add_options(CLI::App& app, TrainOptions& o);
int train_command(const TrainOptions& o);

}  // namespace wetcurl
