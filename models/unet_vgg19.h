// The paper's network on the root codec: VGG19 down, transposed convolutions up, a residual over up(input).
// Figures 19 and 20, Table 1. All convolutions 5x5, stride 1, padding 2, ReLU but after the last and the
// doublings; skips are taken before the pool (only that matches Table 1). 60,031,235 parameters at width 1.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "models/layers.h"

namespace wetcurl {

class UnetVgg19 : public TorchNetwork {
  public:
    // Without doubling r6 is left out.
    explicit UnetVgg19(double width, ImageChannels channels = {});
    // Codec root: up(input) and the residual.
    Tensor forward(const Tensor& input) override;
    // (B, in, h, w) to (B, out, 2h, 2w), or without doubling (B, out, h, w), single precision; any h and w:
    // padded to multiples of 32 by repeating the edge, then cropped.
    Tensor residual(const Tensor& input);
    // Where set, receives each block's name (C1…C5, r1…r7) and output (before the pool).
    std::function<void(const std::string& block, const Tensor& output)> watch;
    // In half precision on a device of compute capability 9.0 the kernels of models/unet_vgg19_kernels.h run
    // it from then on, where it has up to most_last_outputs.
    void freeze() override;

  private:
    // Weights as those kernels take them.
    struct Frozen;
    struct Level {
        std::string name;
        torch::nn::ConvTranspose2d doubling{nullptr};  // going up alone
        std::vector<torch::nn::Conv2d> convolutions;
    };
    Tensor run(Level& level, Tensor x);
    // By those kernels: as `answer`, of so many pixels, of an input whose sides are padded.
    Tensor run(const Frozen& frozen, const Tensor& input, const Tensor& base, long height, long width);
    // The residual, and up(base) where that is defined.
    Tensor answer(const Tensor& input, const Tensor& base);
    void add_convolutions(Level& level, int in, int out, int count);

    long scale_;  // of the output's sides
    std::vector<Level> down_, up_;
    torch::nn::Conv2d last_{nullptr};
    std::shared_ptr<const Frozen> frozen_;
};

}  // namespace wetcurl
