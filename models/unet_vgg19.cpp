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
    struct Doubling {
        Tensor weight, bias;  // (4 O, C), (4 O)
    };
    std::vector<Doubling> doublings;
    Tensor last, last_bias;  // (8, 5, 5, C), 0 beyond the outputs; in single precision
};

void UnetVgg19::freeze() {
    Model::freeze();
    frozen_ = nullptr;
    const torch::NoGradGuard no_grad;
    const Tensor& last = last_->weight;
    if (body != torch::kHalf || !last.is_cuda() || last.size(0) > 8) return;
    const c10::cuda::CUDAGuard guard(last.device());
    if (!can_launch_last(int(last.size(1)))) return;
    auto frozen = std::make_shared<Frozen>();
    for (auto& level : up_) {
        const Tensor &weight = level.doubling->weight, &bias = level.doubling->bias;
        frozen->doublings.push_back({doubling_rows(weight).contiguous(), bias.repeat({4})});
    }
    frozen->last = torch::constant_pad_nd(last, {0, 0, 0, 0, 0, 0, 0, 8 - last.size(0)})
                       .permute({0, 2, 3, 1})
                       .to(torch::kHalf)
                       .contiguous();
    frozen->last_bias = last_->bias;
    frozen_ = frozen;
}

namespace {

cudaStream_t stream_of(const Tensor& x) { return c10::cuda::getCurrentCUDAStream(x.device().index()); }

Tensor by_pixels(const Tensor& x) { return x.contiguous(torch::MemoryFormat::ChannelsLast); }

Tensor empty_image(const Tensor& like, long channels, long height, long width) {
    return torch::empty({like.size(0), channels, height, width}, like.options(),
                        torch::MemoryFormat::ChannelsLast);
}

// ReLU of the layer's convolution.
Tensor convolved(nn::Conv2d& layer, const Tensor& x, const JoinedImage& in) {
    const Tensor out = empty_image(x, layer->weight.size(0), in.height, in.width);
    if (launch_convolution(in, layer->weight.data_ptr(), layer->bias.data_ptr(), int(out.size(1)),
                           out.data_ptr(), stream_of(x)))
        return out;
    if (!in.doubled) return by_pixels(run_relu(layer, x));
    const Tensor joined = empty_image(x, in.channels(), in.height, in.width);
    launch_join(in, joined.data_ptr(), stream_of(x));
    return by_pixels(run_relu(layer, joined));
}

JoinedImage image_of(const Tensor& x) {
    return {int(x.size(0)), int(x.size(2)), int(x.size(3)), nullptr, x.data_ptr(), 0, int(x.size(1))};
}

// x as its doubling gives it, (pixels, 4 O), then `skip` where there is one.
JoinedImage image_of(const Tensor& x, const Tensor& doubled, const Tensor& skip) {
    return {int(x.size(0)),
            int(2 * x.size(2)),
            int(2 * x.size(3)),
            doubled.data_ptr(),
            skip.defined() ? skip.data_ptr() : nullptr,
            int(doubled.size(1) / 4),
            skip.defined() ? int(skip.size(1)) : 0};
}

}  // namespace

Tensor UnetVgg19::run(const Frozen& frozen, Tensor x, const Tensor& base, long height, long width) {
    const c10::cuda::CUDAGuard guard(x.device());
    x = by_pixels(x);
    auto run_level = [&](Level& level, JoinedImage in) {
        for (auto& layer : level.convolutions) x = convolved(layer, x, in), in = image_of(x);
        if (watch) watch(level.name, x);
    };
    std::vector<Tensor> skips;
    for (auto& level : down_) {
        run_level(level, image_of(x));
        skips.push_back(x);
        const Tensor half = empty_image(x, x.size(1), x.size(2) / 2, x.size(3) / 2);
        launch_pool(int(x.size(0)), int(x.size(2)), int(x.size(3)), int(x.size(1)), x.data_ptr(),
                    half.data_ptr(), stream_of(x));
        x = half;
    }
    for (size_t k = 0; k < up_.size(); ++k) {
        const auto& doubling = frozen.doublings[k];
        const Tensor doubled = linear_rows(to_rows(x), doubling.weight, doubling.bias),
                     skip = skips.empty() ? Tensor() : skips.back();
        if (!skips.empty()) skips.pop_back();
        run_level(up_[k], image_of(x, doubled, skip));
    }
    const long outputs = last_->weight.size(0);
    const Tensor out = torch::empty({x.size(0), outputs, height, width}, x.options().dtype(torch::kFloat),
                                    torch::MemoryFormat::Contiguous),
                 from = base.defined() && !watch ? base.contiguous() : Tensor();
    launch_last(int(x.size(0)), int(x.size(2)), int(x.size(3)), int(x.size(1)), x.data_ptr(),
                frozen.last.data_ptr(), frozen.last_bias.data_ptr<float>(), int(outputs),
                from.defined() ? from.data_ptr<float>() : nullptr, int(height), int(width),
                out.data_ptr<float>(), stream_of(x));
    if (!watch) return out;
    watch("r7", out);  // the residual alone
    return base.defined() ? up(base) + out : out;
}
#else
struct UnetVgg19::Frozen {};
void UnetVgg19::freeze() { Model::freeze(); }
#endif

Tensor UnetVgg19::answer(const Tensor& input, const Tensor& base) {
    const long h = input.size(2), w = input.size(3);
    const long below = (multiple - h % multiple) % multiple, right = (multiple - w % multiple) % multiple;
    // On the CPU LibTorch repeats edges in single precision alone.
    Tensor x = input.is_cpu() ? input.to(torch::kFloat) : input;
    if (below || right) x = torch::replication_pad2d(x, {0, right, 0, below});
    x = x.to(body, /*non_blocking=*/false, /*copy=*/false, torch::MemoryFormat::ChannelsLast);
#ifdef WETCURL_MODEL_KERNELS
    if (frozen_ && x.is_cuda() && body == torch::kHalf) return run(*frozen_, x, base, scale_ * h, scale_ * w);
#endif
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
