// The paper's network on the root codec.
// Figures 19 and 20, Table 1.
#include "models/unet_vgg19.h"

namespace wetcurl {

namespace nn = torch::nn;

namespace {
constexpr int kernel = 5;
constexpr int pools = 5;
constexpr int multiple = 1 << pools;
struct Row {
    int channels, convolutions;
};
constexpr Row down_table[pools] = {{64, 2}, {128, 2}, {256, 4}, {512, 4}, {512, 4}};         // C1…C5
constexpr Row up_table[pools + 1] = {{64, 4}, {64, 4}, {64, 4}, {64, 2}, {64, 2}, {64, 2}};  // r1…r6
}  // namespace

void UnetVgg19::add_convolutions(Level& level, int in, int out, int count) {
    for (int i = 0; i < count; ++i)
        level.convolutions.push_back(
            register_module(level.name + "_" + std::to_string(i), convolution(i ? out : in, out, kernel)));
}

UnetVgg19::UnetVgg19(double width, ImageChannels image) : scale_(image.doubles ? 2 : 1) {
    int channels = image.in;
    std::vector<int> skips;
    for (const Row& row : down_table) {
        Level level;
        level.name = "C";
        level.name += std::to_string(down_.size() + 1);
        const int out = scaled_channels(row.channels, width);
        add_convolutions(level, channels, out, row.convolutions);
        skips.push_back(channels = out);
        down_.push_back(level);
    }
    for (const Row& row : up_table) {
        if (up_.size() == pools && !image.doubles) break;
        Level level;
        level.name = "r";
        level.name += std::to_string(up_.size() + 1);
        const int out = scaled_channels(row.channels, width);
        level.doubling = register_module(
            level.name + "_up", nn::ConvTranspose2d(nn::ConvTranspose2dOptions(channels, out, 2).stride(2)));
        // Each output pixel has one source pixel: the fan is that of a 1x1 layer, without a ReLU behind it.
        nn::init::normal_(level.doubling->weight, 0, 1 / std::sqrt(double(channels)));
        nn::init::zeros_(level.doubling->bias);
        const int skip = skips.empty() ? 0 : skips.back();  // r6 has none left
        if (!skips.empty()) skips.pop_back();
        add_convolutions(level, out + skip, out, row.convolutions);
        channels = out;
        up_.push_back(level);
    }
    last_ = register_module("r7", convolution(channels, image.out, kernel));
    set_zero(*last_);
}

Tensor UnetVgg19::run(Level& level, Tensor x) {
    for (auto& layer : level.convolutions) x = run_relu(layer, x);
    if (watch) watch(level.name, x);
    return x;
}

Tensor UnetVgg19::residual(const Tensor& input) {
    const long h = input.size(2), w = input.size(3);
    const long below = (multiple - h % multiple) % multiple, right = (multiple - w % multiple) % multiple;
    // On the CPU LibTorch repeats edges in single precision alone.
    Tensor x = input.is_cpu() ? input.to(torch::kFloat) : input;
    if (below || right) x = torch::replication_pad2d(x, {0, right, 0, below});
    x = x.to(body, /*non_blocking=*/false, /*copy=*/false, torch::MemoryFormat::ChannelsLast);
    std::vector<Tensor> skips;
    for (auto& level : down_) {
        skips.push_back(run(level, x));          // (B, C, s, s)
        x = torch::max_pool2d(skips.back(), 2);  // (B, C, s/2, s/2)
    }
    for (auto& level : up_) {
        x = run_doubling(level.doubling, x);
        if (!skips.empty()) {
            x = torch::cat({x, skips.back()}, 1);
            skips.pop_back();
        }
        x = run(level, x);
    }
    const Tensor out =
        run_layer(last_, x.to(torch::kFloat)).narrow(2, 0, scale_ * h).narrow(3, 0, scale_ * w);
    if (watch) watch("r7", out);
    return out;
}

Tensor UnetVgg19::forward(const Tensor& input) { return up(input) + residual(input); }

}  // namespace wetcurl
