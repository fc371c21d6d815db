// The list of the networks.
#include "models/registry.h"

#include <ATen/Context.h>
#include <torch/cuda.h>
#include <torch/utils.h>

#include <algorithm>
#include <cstdlib>
#include <thread>

#include "base/error.h"
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

std::shared_ptr<Model> make_unet(const ModelCard& card) { return std::make_shared<UnetVgg19>(card.width); }
std::shared_ptr<Model> make_recursive(const ModelCard& card) {
    return std::make_shared<RecursiveResidual>(card.width);
}
std::shared_ptr<Model> make_adhesion(const ModelCard&) { return std::make_shared<AdhesionMlp>(); }
struct Normalisation {
    Tensor mean, deviation, scale;
};
Normalisation normalisation_of(const ModelCard& card) {
    return {array_of(card, "input_mean", card.input_channels, 0),
            array_of(card, "input_std", card.input_channels, 1),
            array_of(card, "output_scale", card.output_channels, 1)};
}
template <bool neighbours>
std::shared_ptr<Model> make_strand(const ModelCard& card) {
    const Normalisation n = normalisation_of(card);
    return std::make_shared<StrandMlp>(card.width, n.mean, n.deviation, n.scale, neighbours);
}
template <class Network>
std::shared_ptr<Model> make_strand_image(const ModelCard& card) {
    const Normalisation n = normalisation_of(card);
    return std::make_shared<StrandImage<Network>>(card.width, n.mean, n.deviation, n.scale);
}
std::shared_ptr<Model> make_linear(const ModelCard& card) {
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
    static const std::vector<Architecture> list = {
        {"unet_vgg19", "root", 3, 3, 2, true, true, make_unet},
        {"recursive_residual", "root", 3, 3, 2, true, true, make_recursive},
        {"strand_mlp", "strand", 0, 72, 1, true, false, make_strand<false>},
        {"strand_depthwise", "strand", 0, 72, 1, true, true, make_strand<true>},
        {"strand_linear", "strand", 0, 72, 1, false, false, make_linear},
        {"strand_unet_vgg19", "strand", 0, 72, 1, true, true, make_strand_image<UnetVgg19>},
        {"strand_recursive_residual", "strand", 0, 72, 1, true, true, make_strand_image<RecursiveResidual>},
        {"adhesion_mlp", "adhesion", 12, 1, 1, false, false, make_adhesion},
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

std::shared_ptr<Model> make_model(const ModelCard& card) {
    const Architecture* architecture = find_architecture(card.architecture);
    if (!architecture)
        throw Error("model: found architecture '" + card.architecture + "', which is not known here");
    return architecture->make(card);
}

torch::Device device_named(const std::string& name) {
    if (name == "cpu") return torch::kCPU;
    const bool numbered = name.rfind("cuda:", 0) == 0 && name.size() > 5 && name.size() < 9 &&
                          name.find_first_not_of("0123456789", 5) == std::string::npos;
    if (name != "cuda" && !numbered) throw Misuse("device: found '" + name + "', allowed cpu, cuda, cuda:N");
    const int index = numbered ? std::atoi(name.c_str() + 5) : 0;
    const int count = int(torch::cuda::device_count());
    if (index >= count)
        throw Error("device " + name + ": this machine and this LibTorch have " + std::to_string(count) +
                    " CUDA devices; --device cpu works everywhere");
    return torch::Device(torch::kCUDA, c10::DeviceIndex(index));
}

void choose(Convolutions how) {
    at::globalContext().setDeterministicCuDNN(how == Convolutions::repeatable);
    at::globalContext().setBenchmarkCuDNN(how == Convolutions::fastest);
}

void set_threads(int threads) {
    torch::set_num_threads(threads > 0 ? threads : int(std::max(1u, std::thread::hardware_concurrency())));
}

}  // namespace wetcurl
