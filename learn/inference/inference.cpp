// Inference: load once, run many.
#include "learn/inference/inference.h"

#include <c10/core/InferenceMode.h>

#include "base/error.h"
#ifdef WETCURL_NETWORKS_ON_DEVICE
#include "learn/inference/device_network.h"
#endif
#include "models/device.h"
#include "models/model_file.h"

namespace wetcurl {
namespace {

// Whether the processor has products in bfloat16: where it has not, they would take longer than in single
// precision.
bool multiplies_bfloat16() {
#ifdef __x86_64__
    return __builtin_cpu_supports("avx512bf16");
#else
    return false;
#endif
}

class NetworkOnCpu final : public Network {
  public:
    NetworkOnCpu(const ModelCard& card, std::shared_ptr<TorchNetwork> model, bool in_bfloat16)
        : card_(card), model_(std::move(model)), strand_layers_(model_->strand_layers()) {
        if (!in_bfloat16) return;
        model_->body = torch::kBFloat16;
        model_->freeze();
    }

    const ModelCard& card() const override { return card_; }
    int reach() const override { return model_->reach(); }
    std::optional<DenseLayers> layers() const override { return model_->dense_layers(); }
    std::optional<StrandLayers> strand_layers() const override { return strand_layers_; }

    // The caller's arrays are seen as tensors where they lie; only the result is copied.
    void run(const float* input, std::array<long, 4> shape, float* output, bool on_device) override {
        require_shape(card_, shape);
        if (on_device)
            throw Error("network " + card_.architecture +
                        ": found memory of a CUDA device, this one runs on the CPU");
        const auto [b, c, h, w] = shape;
        if (b * h * w == 0) return;
        const c10::InferenceMode inference;
        const Tensor y = model_->forward(torch::from_blob(const_cast<float*>(input), {b, c, h, w}));
        torch::from_blob(output, {b, card_.output_channels, h * card_.upscale, w * card_.upscale}).copy_(y);
    }

  private:
    ModelCard card_;
    std::shared_ptr<TorchNetwork> model_;
    std::optional<StrandLayers> strand_layers_;  // before their numbers are rounded
};

}  // namespace

void require_shape(const ModelCard& card, std::array<long, 4> shape) {
    const auto [b, c, h, w] = shape;
    if (c != card.input_channels || b < 0 || h < 0 || w < 0)
        throw Error("network " + card.architecture + ": found an input of " + std::to_string(c) +
                    " channels, needed " + std::to_string(card.input_channels));
}

std::unique_ptr<Network> network_of(const ModelCard& card, std::shared_ptr<TorchNetwork> model,
                                    const std::string& device, int threads, Body body) {
    set_threads(threads);
    const torch::Device on = device_named(device);
    const bool fastest = body == Body::fastest && card.codec != "adhesion";
    if (on.is_cpu())
        return std::make_unique<NetworkOnCpu>(card, std::move(model), fastest && multiplies_bfloat16());
#ifdef WETCURL_NETWORKS_ON_DEVICE
    return device_network(card, std::move(model), on, fastest);
#else
    throw Error("device " + device + ": this build has no CUDA kernels (cmake --preset cuda)");
#endif
}

std::unique_ptr<Network> load_network(const std::string& path, const std::string& device, int threads,
                                      Body body) {
    auto [card, model] = load_model(path);
    return network_of(card, std::move(model), device, threads, body);
}

}  // namespace wetcurl
