// The list of the networks: a name, the codec it serves, how it is made.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "models/layers.h"
#include "models/model_card.h"

namespace wetcurl {

struct Architecture {
    std::string name, codec;
    int input_channels;  // 0: any
    int output_channels, upscale;
    bool scalable;    // whether a width other than 1 is allowed
    bool neighbours;  // whether a pixel's output depends on others
    std::shared_ptr<Model> (*make)(const ModelCard& card);
};

// The first of a codec is its default.
const std::vector<Architecture>& architectures();
// nullptr where there is none of this name.
const Architecture* find_architecture(const std::string& name);
// Throws Misuse where the name ("" : the codec's default) is unknown, serves another codec or does not scale.
const Architecture& architecture_for(const std::string& name, const std::string& codec, double width);
// A fresh network as the card says, initialised from LibTorch's random state; `card.parameters` is not looked
// at.
std::shared_ptr<Model> make_model(const ModelCard& card);

// "cpu", "cuda" or "cuda:1". Throws Misuse for another name, Error where there is no such device.
torch::Device device_named(const std::string& name);
// How CUDA devices convolve from now on: by the same kernels each time; or by those that were the fastest
// when each size came first, which need not be the same, nor give the same bits, in the next process.
enum class Convolutions { repeatable, fastest };
void choose(Convolutions how);
// 0: all of the machine's.
void set_threads(int threads);

}  // namespace wetcurl
