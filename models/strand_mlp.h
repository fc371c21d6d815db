// The network that carries the product: one residual network for every strand, on the strand codec.
// Ours. 1x1 convolutions over the pixels: no strand sees another, so any grid and any number of strands fit.
#pragma once

#include "models/layers.h"

namespace wetcurl {

class StrandMlp : public Model {
  public:
    // 256 channels at width 1; `mean`, `deviation` (C) and `scale` (outputs): of the inputs and of the
    // residual.
    StrandMlp(double width, const Tensor& mean, const Tensor& deviation, const Tensor& scale);
    // (B, C, H, W) in the units of the pairs file to residual amplitudes (B, outputs, H, W) [m].
    Tensor forward(const Tensor& input) override;
    // The same on pixels: (P, C) to (P, outputs).
    Tensor rows(const Tensor& input);

  private:
    Tensor mean_, deviation_, scale_;  // stored with the card, not with the weights
    torch::nn::Linear first_{nullptr}, last_{nullptr};
    std::vector<torch::nn::Linear> blocks_;
};

}  // namespace wetcurl
