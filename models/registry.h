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
    int input_channels = 0;  // 0: any
    int output_channels = 0;
    int upscale = 1;          // pixels of the output a pixel, each way
    bool scalable = false;    // whether a width other than 1 is allowed
    bool neighbours = false;  // whether a pixel's output depends on others
    std::shared_ptr<TorchNetwork> (*make)(const ModelCard& card) = nullptr;
};

// The first of a codec is its default.
const std::vector<Architecture>& architectures();
// nullptr where there is none of this name.
const Architecture* find_architecture(const std::string& name);
// Throws Misuse where the name ("" : the codec's default) is unknown, serves another codec or does not scale.
const Architecture& architecture_for(const std::string& name, const std::string& codec, double width);
// A fresh network as the card says, initialised from LibTorch's random state; `card.parameters` is not looked
// at.
std::shared_ptr<TorchNetwork> make_model(const ModelCard& card);

}  // namespace wetcurl
