// Inference: a model file as a Network. This half of learn needs LibTorch and belongs to its library.
// Ours.
#pragma once

#include <memory>
#include <string>

#include "learn/network.h"

namespace wetcurl {

// `threads` 0: all of the machine's. Throws Error for a bad file or an absent device, Misuse for another
// device name.
std::unique_ptr<Network> load_network(const std::string& path, const std::string& device, int threads);

}  // namespace wetcurl
