// The list of the networks.
#include "models/registry.h"

#include <algorithm>

#include "base/error.h"
#include "base/network_channels.h"
#include "models/adhesion_mlp.h"
#include "models/recursive_residual.h"
#include "models/strand_image.h"
#include "models/strand_mlp.h"
#include "models/unet_vgg19.h"

namespace wetcurl {
namespace {

// An array of the card as a tensor (n), `fallback` everywhere where the card has none.
Tensor array_of(const ModelCard& card, const std::string& name, int n, float fallback) {
    const auto found = card.arrays.find(name);
    if (found == card.arrays.end()) return torch::full({n}, fallback);
    if (found->second.size() != size_t(n))
        throw Error("model: array '" + name + "' holds " + std::to_string(found->second.size()) +
                    " values, needed " + std::to_string(n));
    return torch::tensor(found->second);
}

std::shared_ptr<TorchNetwork> make_unet(const ModelCard& card) {
    return std::make_shared<UnetVgg19>(card.width);
}
std::shared_ptr<TorchNetwork> make_recursive(const ModelCard& card) {
    return std::make_shared<RecursiveResidual>(card.width);
}
std::shared_ptr<TorchNetwork> make_adhesion(const ModelCard&) { return std::make_shared<AdhesionMlp>(); }
struct Normalisation {
    Tensor mean, deviation, scale;
};
Normalisation normalisation_of(const ModelCard& card) {
    return {array_of(card, "input_mean", card.input_channels, 0),
            array_of(card, "input_std", card.input_channels, 1),
            array_of(card, "output_scale", card.output_channels, 1)};
}
template <bool neighbours>
std::shared_ptr<TorchNetwork> make_strand(const ModelCard& card) {
    const Normalisation n = normalisation_of(card);
    return std::make_shared<StrandMlp>(card.width, n.mean, n.deviation, n.scale, neighbours);
}
template <class ImageNetwork>
std::shared_ptr<TorchNetwork> make_strand_image(const ModelCard& card) {
    const Normalisation n = normalisation_of(card);
    return std::make_shared<StrandImage<ImageNetwork>>(card.width, n.mean, n.deviation, n.scale);
}
std::shared_ptr<TorchNetwork> make_linear(const ModelCard& card) {
    const Normalisation n = normalisation_of(card);
    return std::make_shared<StrandLinear>(n.mean, n.deviation, n.scale);
}

std::vector<std::string> names_for(const std::string& codec) {
    std::vector<std::string> names;
    for (const auto& a : architectures())
        if (a.codec == codec) names.push_back(a.name);
    return names;
}

}  // namespace

const std::vector<Architecture>& architectures() {
    constexpr int colours = colour_channels, outputs = strand_outputs;
    // Channels and upscale are those of the codec.
    static const std::vector<Architecture> list = {
        {.name = "unet_vgg19",
         .codec = "root",
         .input_channels = colours,
         .output_channels = colours,
         .upscale = 2,
         .scalable = true,
         .neighbours = true,
         .make = make_unet},
        {.name = "recursive_residual",
         .codec = "root",
         .input_channels = colours,
         .output_channels = colours,
         .upscale = 2,
         .scalable = true,
         .neighbours = true,
         .make = make_recursive},
        {.name = "strand_mlp",
         .codec = "strand",
         .output_channels = outputs,
         .scalable = true,
         .neighbours = false,
         .make = make_strand<false>},
        {.name = "strand_depthwise",
         .codec = "strand",
         .output_channels = outputs,
         .scalable = true,
         .neighbours = true,
         .make = make_strand<true>},
        {.name = "strand_linear",
         .codec = "strand",
         .output_channels = outputs,
         .scalable = false,
         .neighbours = false,
         .make = make_linear},
        {.name = "strand_unet_vgg19",
         .codec = "strand",
         .output_channels = outputs,
         .scalable = true,
         .neighbours = true,
         .make = make_strand_image<UnetVgg19>},
        {.name = "strand_recursive_residual",
         .codec = "strand",
         .output_channels = outputs,
         .scalable = true,
         .neighbours = true,
         .make = make_strand_image<RecursiveResidual>},
        {.name = "adhesion_mlp",
         .codec = "adhesion",
         .input_channels = adhesion_inputs,
         .output_channels = 1,
         .scalable = false,
         .neighbours = false,
         .make = make_adhesion},
    };
    return list;
}

const Architecture* find_architecture(const std::string& name) {
    for (const auto& a : architectures())
        if (a.name == name) return &a;
    return nullptr;
}

const Architecture& architecture_for(const std::string& name, const std::string& codec, double width) {
    const auto allowed = names_for(codec);
    if (allowed.empty()) throw Misuse("codec '" + codec + "': no network serves it");
    const std::string wanted = name.empty() ? allowed.front() : name;
    if (std::find(allowed.begin(), allowed.end(), wanted) == allowed.end()) {
        std::string list;
        for (const auto& a : allowed) list += (list.empty() ? "" : ", ") + a;
        throw Misuse("architecture: found '" + wanted + "', allowed for codec " + codec + ": " + list +
                     did_you_mean(wanted, allowed));
    }
    const Architecture& found = *find_architecture(wanted);
    if (!found.scalable && width != 1)
        throw Misuse("width: found " + std::to_string(width) + ", " + wanted + " has one width, 1");
    return found;
}

std::shared_ptr<TorchNetwork> make_model(const ModelCard& card) {
    const Architecture* architecture = find_architecture(card.architecture);
    if (!architecture)
        throw Error("model: found architecture '" + card.architecture + "', which is not known here");
    return architecture->make(card);
}

}  // namespace wetcurl
