// The paper's smaller network on the root codec.
// Figure 16.
#include "models/recursive_residual.h"

namespace wetcurl {

namespace {
constexpr int kernel = 5, base_channels = 64, blocks = 10, tail = 4;
}

RecursiveResidual::RecursiveResidual(double width, ImageChannels image) : doubles_(image.doubles) {
    const int channels = scaled_channels(base_channels, width);
    head_ = register_module("head", convolution(image.in, channels, kernel));
    for (int i = 0; i < 2 * blocks; ++i) {
        blocks_.push_back(register_module("block" + std::to_string(i / 2) + "_" + std::to_string(i % 2),
                                          convolution(channels, channels, kernel)));
        // Ten sums of like size would grow the signal by 2^5: each adds a tenth of the variance.
        torch::NoGradGuard no_grad;
        if (i % 2) blocks_.back()->weight.mul_(std::sqrt(0.5 / blocks));
    }
    for (int i = 0; i < tail; ++i)
        tail_.push_back(register_module("tail" + std::to_string(i),
                                        convolution(channels, i + 1 < tail ? channels : image.out, kernel)));
    set_zero(*tail_.back());
}

Tensor RecursiveResidual::residual(const Tensor& input) {
    Tensor x = run_layer(head_, input.to(body, /*non_blocking=*/false, /*copy=*/false,
                                         torch::MemoryFormat::ChannelsLast));  // (B, C, h, w)
    for (size_t i = 0; i < blocks_.size(); i += 2) x = x + run_layer(blocks_[i + 1], run_relu(blocks_[i], x));
    if (doubles_) x = up(x);  // (B, C, 2h, 2w)
    for (size_t i = 0; i + 1 < tail_.size(); ++i) x = run_relu(tail_[i], x);
    return run_layer(tail_.back(), x.to(torch::kFloat));
}

Tensor RecursiveResidual::forward(const Tensor& input) { return up(input) + residual(input); }

}  // namespace wetcurl
