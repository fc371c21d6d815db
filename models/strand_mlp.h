// The networks that carry the product, on the strand codec: a residual network over the channels of a pixel,
// and the same with a look at the pixels around before each block. Any grid and any number of strands
// fit.
#pragma once

#include "models/layers.h"

namespace wetcurl {

class StrandMlp : public TorchNetwork {
  public:
    // 256 channels at width 1; `mean`, `deviation` (C) and `scale` (outputs): of the inputs and of the
    // residual. `neighbours`: a depthwise 5x5 convolution before each block; pixels whose inputs are all 0
    // hold no strand, and give the others nothing.
    StrandMlp(double width, const Tensor& mean, const Tensor& deviation, const Tensor& scale,
              bool neighbours);
    // (B, C, H, W) in the units of the pairs file to residual amplitudes (B, outputs, H, W) [m].
    Tensor forward(const Tensor& input) override;
    int reach() const override;
    std::optional<StrandLayers> strand_layers() const override;
    // On a CUDA device in half precision the kernels of models/strand_mlp_kernels.h run it from then on.
    void freeze() override;

  private:
    // Weights as those kernels take them.
    struct Frozen;
    Tensor run(const Frozen& frozen, const Tensor& input) const;
    // x (P, channels) and what the pixels around it say; `mask` (P, 1): undefined where all hold strands.
    Tensor mixed(const Tensor& x, torch::nn::Conv2d& layer, const Tensor& mask, const Tensor& like);

    Tensor mean_, deviation_, scale_;  // stored with the card, not with the weights
    torch::nn::Linear first_{nullptr}, last_{nullptr};
    std::vector<torch::nn::Linear> blocks_;
    std::vector<torch::nn::Conv2d> mixers_;
    std::shared_ptr<const Frozen> frozen_;
};

// Linear regression on the same inputs, what a network has to beat; weight_decay is its ridge.
class StrandLinear : public TorchNetwork {
  public:
    StrandLinear(const Tensor& mean, const Tensor& deviation, const Tensor& scale);
    // As of StrandMlp.
    Tensor forward(const Tensor& input) override;
    int reach() const override { return 0; }

  private:
    Tensor mean_, deviation_, scale_;
    torch::nn::Linear only_{nullptr};
};

}  // namespace wetcurl
