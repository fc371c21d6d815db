// The paper's network on the root codec.
// Figures 19 and 20, Table 1.
#include "models/unet_vgg19.h"

#ifdef WETCURL_MODEL_KERNELS
#include <c10/cuda/CUDAGuard.h>
#include <c10/cuda/CUDAStream.h>

#include "models/unet_vgg19_kernels.h"
#endif

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

#ifdef WETCURL_MODEL_KERNELS
struct UnetVgg19::Frozen {
    struct Layer {
        Tensor weight, bias;
    };
    struct Level {
        Layer doubling;                   // (4 O, C), (4 O)
        std::vector<Layer> convolutions;  // as launch_convolution takes them
    };
    std::vector<Level> down, up;
    Layer last;  // as launch_last takes it
};

namespace {

long filled_up(long channels) { return (channels + outputs_at_once - 1) / outputs_at_once * outputs_at_once; }
long as_taken(long channels) {
    return (channels + channels_at_once - 1) / channels_at_once * channels_at_once;
}

// Zeros at the end of a dimension, up to `size`.
Tensor filled(const Tensor& x, long dimension, long size) {
    std::vector<long> pad(size_t(2 * (x.dim() - dimension)), 0);
    pad.back() = size - x.size(dimension);
    return torch::constant_pad_nd(x, pad);
}

// weight (O, C, 5, 5) to (O / 64, C / 16, 5, 5, 2, 64, 8).
Tensor by_blocks(const Tensor& weight) {
    return weight
        .view({weight.size(0) / outputs_at_once, outputs_at_once, weight.size(1) / channels_at_once, 2, 8,
               kernel, kernel})
        .permute({0, 2, 5, 6, 3, 1, 4})
        .contiguous();
}

}  // namespace

void UnetVgg19::freeze() {
    TorchNetwork::freeze();
    frozen_ = nullptr;
    const torch::NoGradGuard no_grad;
    const Tensor& last = last_->weight;
    if (body != torch::kHalf || !last.is_cuda() || last.size(0) > most_last_outputs) return;
    const c10::cuda::CUDAGuard guard(last.device());
    auto frozen = std::make_shared<Frozen>();
    bool can = can_launch_last(int(filled_up(last.size(1))));
    // Channels of an image that a doubling and a skip make are filled up each for itself.
    auto add = [&](std::vector<Frozen::Level>& to, Level& level, long doubled) {
        Frozen::Level in_order;
        if (level.doubling) {
            const Tensor &weight = level.doubling->weight, &bias = level.doubling->bias;
            const long inputs = filled_up(weight.size(0)), outputs = filled_up(weight.size(1));
            in_order.doubling = {doubling_rows(filled(filled(weight, 0, inputs), 1, outputs)).contiguous(),
                                 filled(bias, 0, outputs).repeat({4})};
        }
        for (auto& layer : level.convolutions) {
            const Tensor &weight = layer->weight, &bias = layer->bias;
            const long outputs = filled_up(weight.size(0)), skip = weight.size(1) - doubled;
            const bool takes_input = to.empty() && in_order.convolutions.empty() && !level.doubling;
            Tensor whole =
                filled(weight.narrow(1, doubled, skip), 1, takes_input ? as_taken(skip) : filled_up(skip));
            if (doubled)
                whole = torch::cat({filled(weight.narrow(1, 0, doubled), 1, filled_up(doubled)), whole}, 1);
            can = can && can_convolve(int(whole.size(1)));
            in_order.convolutions.push_back({by_blocks(filled(whole, 0, outputs)), filled(bias, 0, outputs)});
            doubled = 0;
        }
        to.push_back(in_order);
    };
    for (auto& level : down_) add(frozen->down, level, 0);
    for (auto& level : up_) add(frozen->up, level, level.doubling->weight.size(1));
    const long channels = filled_up(last.size(1));
    const Tensor by_taps = filled(last, 1, channels).permute({2, 3, 0, 1}).reshape({-1, channels});
    frozen->last = {filled(by_taps, 0, last_columns).to(torch::kHalf).contiguous(), last_->bias};
    if (can) frozen_ = frozen;
}

namespace {

cudaStream_t stream_of(const Tensor& x) { return c10::cuda::getCurrentCUDAStream(x.device().index()); }

// x (B, H, W, C).
JoinedImage image_of(const Tensor& x) {
    return {int(x.size(0)), int(x.size(1)), int(x.size(2)), nullptr, x.data_ptr(), 0, int(x.size(3))};
}
// x (B, H, W, C) as its doubling gives it, (pixels, 4 O), then `skip` where there is one.
JoinedImage image_of(const Tensor& x, const Tensor& doubled, const Tensor& skip) {
    return {int(x.size(0)),
            int(2 * x.size(1)),
            int(2 * x.size(2)),
            doubled.data_ptr(),
            skip.defined() ? skip.data_ptr() : nullptr,
            int(doubled.size(1) / 4),
            skip.defined() ? int(skip.size(3)) : 0};
}

}  // namespace

Tensor UnetVgg19::run(const Frozen& frozen, const Tensor& input, const Tensor& base, long height,
                      long width) {
    const c10::cuda::CUDAGuard guard(input.device());
    const auto in_half = input.options().dtype(torch::kHalf).memory_format(torch::MemoryFormat::Contiguous);
    const Tensor from = input.contiguous();
    const long images = from.size(0), channels = from.size(1);
    Tensor x = torch::empty({images, from.size(2), from.size(3), as_taken(channels)}, in_half), pooled;
    launch_take(int(images), int(from.size(2)), int(from.size(3)), int(channels), int(x.size(3)),
                from.data_ptr<float>(), x.data_ptr(), stream_of(x));
    auto convolve = [&](const Frozen::Level& level, Level& reference, JoinedImage in, bool pools) {
        for (const auto& [weight, bias] : level.convolutions) {
            const bool last = &weight == &level.convolutions.back().weight;
            x = torch::empty({images, in.height, in.width, bias.size(0)}, in_half);
            if (last && pools)
                pooled = torch::empty({images, in.height / 2, in.width / 2, bias.size(0)}, in_half);
            launch_convolution(in, weight.data_ptr(), bias.data_ptr(), int(bias.size(0)), x.data_ptr(),
                               last && pools ? pooled.data_ptr() : nullptr, stream_of(x));
            in = image_of(x);
        }
        if (watch)
            watch(reference.name,
                  x.narrow(3, 0, reference.convolutions.back()->weight.size(0)).permute({0, 3, 1, 2}));
    };
    std::vector<Tensor> skips;
    for (size_t k = 0; k < down_.size(); ++k) {
        convolve(frozen.down[k], down_[k], image_of(x), true);
        skips.push_back(x), x = pooled;
    }
    for (size_t k = 0; k < up_.size(); ++k) {
        const auto& [weight, bias] = frozen.up[k].doubling;
        const Tensor doubled = linear_rows(x.view({-1, x.size(3)}), weight, bias),
                     skip = skips.empty() ? Tensor() : skips.back();
        if (!skips.empty()) skips.pop_back();
        convolve(frozen.up[k], up_[k], image_of(x, doubled, skip), false);
    }
    const long outputs = last_->weight.size(0);
    const Tensor out = torch::empty({images, outputs, height, width}, from.options()),
                 above = base.defined() && !watch ? base.contiguous() : Tensor();
    launch_last(image_of(x), frozen.last.weight.data_ptr(), frozen.last.bias.data_ptr<float>(), int(outputs),
                above.defined() ? above.data_ptr<float>() : nullptr, int(height), int(width),
                out.data_ptr<float>(), stream_of(x));
    if (!watch) return out;
    watch("r7", out);  // the residual alone
    return base.defined() ? up(base) + out : out;
}
#else
struct UnetVgg19::Frozen {};
void UnetVgg19::freeze() { TorchNetwork::freeze(); }
#endif

Tensor UnetVgg19::answer(const Tensor& input, const Tensor& base) {
    const long h = input.size(2), w = input.size(3);
    const long below = (multiple - h % multiple) % multiple, right = (multiple - w % multiple) % multiple;
    // On the CPU LibTorch repeats edges in single precision alone.
    Tensor x = input.is_cpu() ? input.to(torch::kFloat) : input;
    if (below || right) x = torch::replication_pad2d(x, {0, right, 0, below});
#ifdef WETCURL_MODEL_KERNELS
    if (frozen_ && x.is_cuda() && body == torch::kHalf) return run(*frozen_, x, base, scale_ * h, scale_ * w);
#endif
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
    return base.defined() ? up(base) + out : out;
}

Tensor UnetVgg19::residual(const Tensor& input) { return answer(input, {}); }
Tensor UnetVgg19::forward(const Tensor& input) { return answer(input, input); }

}  // namespace wetcurl
