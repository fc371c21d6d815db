// Networks to be timed.
#pragma once

#include "learn/codec/network_module.h"

namespace wetcurl {

// See NetworkModule.
MeasuredNetwork measured_inference(const ModelCard& card, std::array<long, 4> shape,
                                   const std::string& device, int threads);
MeasuredNetwork measured_training(const ModelCard& card, std::array<long, 4> shape, const std::string& device,
                                  int threads, bool deterministic);

}  // namespace wetcurl
