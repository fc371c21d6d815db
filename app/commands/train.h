// `wetcurl train`: training of a network.
#pragma once

#include "app/engine/train_network.h"

namespace wetcurl {

struct TrainOptions : TrainingRequest {
    static constexpr const char *command = "train", *summary = "train a network on pairs";
};

void add_options(OptionList& options, TrainOptions& o);
int train_command(const TrainOptions& o);

}  // namespace wetcurl
