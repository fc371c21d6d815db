// The training loop.
#pragma once

#include "learn/codec/network_module.h"

namespace wetcurl {

// See NetworkModule::train.
void train(const TrainRequest& request);

}  // namespace wetcurl
