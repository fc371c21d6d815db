// The adhesion force as a network: twelve scalars of a particle and its two chain neighbours give F.n.
// Figure 18, Eq 20: 12-6-5-4-1 with LeakyReLU, 142 parameters. Inputs and output:
// AdhesionChannels and learn/codec/adhesion_samples.h.
#pragma once

#include "models/layers.h"

namespace wetcurl {

class AdhesionMlp : public TorchNetwork {
  public:
    AdhesionMlp();
    // (B, 12, H, W) to (B, 1, H, W), both without units.
    Tensor forward(const Tensor& input) override;
    std::optional<DenseLayers> dense_layers() const override;

  private:
    std::vector<torch::nn::Linear> layers_;
};

}  // namespace wetcurl
