// The paper's smaller network on the root codec: ten residual blocks, doubling, four convolutions.
// Figure 16. All 5x5; 2,366,339 parameters at width 1, unshared.
#pragma once

#include "models/layers.h"

namespace wetcurl {

class RecursiveResidual : public Model {
  public:
    explicit RecursiveResidual(double width);
    // (B, 3, h, w) to (B, 3, 2h, 2w).
    Tensor forward(const Tensor& input) override;

  private:
    torch::nn::Conv2d head_{nullptr};
    std::vector<torch::nn::Conv2d> blocks_, tail_;
};

}  // namespace wetcurl
