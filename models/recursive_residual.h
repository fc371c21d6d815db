// The paper's smaller network on the root codec: ten residual blocks, doubling, four convolutions.
// Figure 16. All 5x5; 2,366,339 parameters at width 1, unshared.
#pragma once

#include "models/layers.h"

namespace wetcurl {

class RecursiveResidual : public TorchNetwork {
  public:
    explicit RecursiveResidual(double width, ImageChannels channels = {});
    // Codec root: up(input) and the residual.
    Tensor forward(const Tensor& input) override;
    // (B, in, h, w) to (B, out, 2h, 2w), or without doubling (B, out, h, w), single precision.
    Tensor residual(const Tensor& input);

  private:
    bool doubles_;
    torch::nn::Conv2d head_{nullptr};
    std::vector<torch::nn::Conv2d> blocks_, tail_;
};

}  // namespace wetcurl
