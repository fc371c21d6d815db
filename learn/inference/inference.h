// Inference: a model as a Network. This half of learn needs LibTorch and belongs to its library.
#pragma once

#include <memory>
#include <string>

#include "learn/codec/network.h"
#include "models/layers.h"

namespace wetcurl {

// `threads` 0: all of the machine's. Throws Error for a bad file or an absent device, Misuse for another
// device name.
std::unique_ptr<Network> load_network(const std::string& path, const std::string& device, int threads,
                                      Body body = Body::fastest);
std::unique_ptr<Network> network_of(const ModelCard& card, std::shared_ptr<TorchNetwork> model,
                                    const std::string& device, int threads, Body body = Body::fastest);

// Throws Error where the network takes no input of this shape.
void require_shape(const ModelCard& card, std::array<long, 4> shape);

}  // namespace wetcurl
