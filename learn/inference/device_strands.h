// Learned wet strands on a CUDA device: codec and network in one CUDA graph, tensors on the codec's own
// memory. This half of learn needs LibTorch with CUDA and belongs to its library.
#pragma once

#include <string>

#include "learn/codec/learned_strands.h"

namespace wetcurl {

// `path`: the model, `device` "cuda" or "cuda:n"; the network's body computes in half precision where `half`.
// Throws Error for a bad file or an absent device.
std::unique_ptr<LearnedStrands> device_strands(const std::string& path, const std::string& device,
                                               const StrandCodec& codec, const Groom& low, bool half);

}  // namespace wetcurl
