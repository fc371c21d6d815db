// Residual networks for strands.
// Ours.
#include "models/strand_mlp.h"

#ifdef WETCURL_MODEL_KERNELS
#include <c10/cuda/CUDAStream.h>

#include "models/mix_kernel.h"
#endif

namespace wetcurl {

namespace {
constexpr int base_channels = 256, blocks = 5, kernel = 5;
}  // namespace

StrandMlp::StrandMlp(double width, const Tensor& mean, const Tensor& deviation, const Tensor& scale,
                     bool neighbours)
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
    // They start at 0, where the network is the one that sees no neighbours.
    for (int i = 0; neighbours && i < blocks; ++i) {
        const auto options = torch::nn::Conv2dOptions(channels, channels, kernel)
                                 .padding(kernel / 2)
                                 .groups(channels)
                                 .bias(false);
        mixers_.push_back(register_module("mixer" + std::to_string(i), torch::nn::Conv2d(options)));
        set_zero(*mixers_.back());
    }
    last_ = register_module("last", dense(channels, int(scale.size(0))));
    set_zero(*last_);
}

Tensor StrandMlp::mixed(const Tensor& x, torch::nn::Conv2d& layer, const Tensor& mask, const Tensor& like) {
    const Tensor weight = layer->weight.to(x.scalar_type());
#ifdef WETCURL_MODEL_KERNELS
    // In bfloat16, in which networks learn, LibTorch's convolution does it.
    if (x.is_cuda() && x.scalar_type() == torch::kHalf && !torch::GradMode::is_enabled()) {
        const Tensor rows = x.contiguous(), out = torch::empty_like(rows), taps = weight.contiguous();
        const GridOfRows grid{int(like.size(0)), int(like.size(2)), int(like.size(3)), int(x.size(1))};
        launch_mix(grid, rows.data_ptr(), mask.defined() ? mask.data_ptr() : nullptr, taps.data_ptr(),
                   out.data_ptr(), c10::cuda::getCurrentCUDAStream(x.device().index()));
        return out;
    }
#endif
    const Tensor around = torch::conv2d(from_rows(mask.defined() ? x * mask : x, like), weight, {},
                                        /*stride=*/1, kernel / 2, /*dilation=*/1, x.size(1));
    return to_rows(around).add_(x);
}

Tensor StrandMlp::forward(const Tensor& input) {
    const Tensor rows = to_rows(input);  // (P, C)
    const Tensor mask = mixers_.empty() || whole_grid ? Tensor() : rows.ne(0).any(1, true).to(body);
    Tensor x = run_layer(first_, normalised(rows, mean_, deviation_, body));  // (P, channels)
    for (size_t i = 0; i < blocks_.size(); i += 2) {
        const Tensor seen = mixers_.empty() ? x : mixed(x, mixers_[i / 2], mask, input);
        x = run_layer(blocks_[i + 1], run_layer(blocks_[i], seen).relu_()).add_(x);
    }
    return from_rows(run_layer(last_, torch::relu(x).to(torch::kFloat)) * scale_, input);
}

StrandLinear::StrandLinear(const Tensor& mean, const Tensor& deviation, const Tensor& scale)
    : mean_(register_buffer("mean", mean)),
      deviation_(register_buffer("deviation", deviation)),
      scale_(register_buffer("scale", scale)),
      only_(register_module("only", dense(int(mean.size(0)), int(scale.size(0))))) {
    set_zero(*only_);
}

Tensor StrandLinear::forward(const Tensor& input) {
    const Tensor rows = normalised(to_rows(input), mean_, deviation_, body);
    return from_rows(run_layer(only_, rows).to(torch::kFloat) * scale_, input);
}

}  // namespace wetcurl
