// One residual network for every strand.
// Ours.
#include "models/strand_mlp.h"

namespace wetcurl {

namespace {
constexpr int base_channels = 256, blocks = 5;
}

StrandMlp::StrandMlp(double width, const Tensor& mean, const Tensor& deviation, const Tensor& scale)
    : mean_(register_buffer("mean", mean)),
      deviation_(register_buffer("deviation", deviation)),
      scale_(register_buffer("scale", scale)) {
    const int channels = scaled_channels(base_channels, width);
    first_ = register_module("first", dense(int(mean.size(0)), channels));
    for (int i = 0; i < 2 * blocks; ++i) {
        blocks_.push_back(register_module("block" + std::to_string(i / 2) + "_" + std::to_string(i % 2),
                                          dense(channels, channels)));
        // Five sums of like size would grow the signal by 2^2.5: each adds a fifth of the variance.
        torch::NoGradGuard no_grad;
        if (i % 2) blocks_.back()->weight.mul_(std::sqrt(0.5 / blocks));
    }
    last_ = register_module("last", dense(channels, int(scale.size(0))));
    set_zero(*last_);
}

Tensor StrandMlp::rows(const Tensor& input) {
    Tensor x = run_layer(first_, ((input - mean_) / deviation_).to(body));  // (P, channels)
    for (size_t i = 0; i < blocks_.size(); i += 2)
        x = x + run_layer(blocks_[i + 1], run_layer(blocks_[i], x).relu_());
    return run_layer(last_, torch::relu(x).to(torch::kFloat)) * scale_;
}

Tensor StrandMlp::forward(const Tensor& input) { return from_rows(rows(to_rows(input)), input); }

}  // namespace wetcurl
