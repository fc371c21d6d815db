// A network on a CUDA device.
#pragma once

#include <memory>
#include <string>

#include "learn/codec/network.h"
#include "models/layers.h"

namespace wetcurl {

// One CUDA graph a shape of input, captured at its second run in a row; the kernels of its convolutions are
// chosen by their time. `half`: the body in half precision.
std::unique_ptr<Network> device_network(const ModelCard& card, std::shared_ptr<TorchNetwork> model,
                                        torch::Device device, bool half);

}  // namespace wetcurl
