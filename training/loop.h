// The training loop.
// Ours.
#pragma once

#include "learn/network_module.h"

namespace wetcurl {

// See NetworkModule::train.
int train(const TrainRequest& request);

}  // namespace wetcurl
