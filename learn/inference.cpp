// Inference: load once, run many.
// Ours.
#include "learn/inference.h"

#include <c10/core/InferenceMode.h>

#include "base/error.h"
#include "models/model_file.h"
#include "models/registry.h"

namespace wetcurl {
namespace {

class LoadedNetwork : public Network {
  public:
    LoadedNetwork(const std::string& path, const std::string& device) : device_(device_named(device)) {
        std::tie(card_, model_) = load_model(path);
        model_->to(device_);
    }

    const ModelCard& card() const override { return card_; }

    // The caller's arrays are seen as tensors where they lie; on the CPU only the result is copied.
    void run(const float* input, std::array<long, 4> shape, float* output) override {
        const auto [b, c, h, w] = shape;
        if (c != card_.input_channels || b < 0 || h < 0 || w < 0)
            throw Error("network " + card_.architecture + ": found an input of " + std::to_string(c) +
                        " channels, needed " + std::to_string(card_.input_channels));
        if (b * h * w == 0) return;
        const c10::InferenceMode inference;
        const Tensor x = torch::from_blob(const_cast<float*>(input), {b, c, h, w});
        const Tensor y = model_->forward(x.to(device_));
        torch::from_blob(output, {b, card_.output_channels, h * card_.upscale, w * card_.upscale}).copy_(y);
    }

  private:
    torch::Device device_;
    ModelCard card_;
    std::shared_ptr<Model> model_;
};

}  // namespace

std::unique_ptr<Network> load_network(const std::string& path, const std::string& device, int threads) {
    set_threads(threads);
    return std::make_unique<LoadedNetwork>(path, device);
}

}  // namespace wetcurl
