// Residual networks for strands.
#include "models/strand_mlp.h"

#ifdef WETCURL_MODEL_KERNELS
#include <c10/cuda/CUDAStream.h>

#include "models/strand_mlp_kernels.h"
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

std::optional<StrandLayers> StrandMlp::strand_layers() const {
    static_assert(StrandLayers::kernel == kernel);
    auto numbers = [](const Tensor& x) {
        const Tensor on_host = x.detach().to(torch::kCPU, torch::kFloat).contiguous();
        return std::vector<float>(on_host.data_ptr<float>(), on_host.data_ptr<float>() + on_host.numel());
    };
    auto dense = [&](const torch::nn::Linear& layer) {
        return StrandLayers::Dense{numbers(layer->weight), numbers(layer->bias)};
    };
    StrandLayers out;
    out.inputs = int(mean_.size(0)), out.channels = int(first_->bias.size(0)),
    out.outputs = int(scale_.size(0));
    out.mean = numbers(mean_), out.deviation = numbers(deviation_), out.scale = numbers(scale_);
    out.first = dense(first_), out.last = dense(last_);
    for (size_t i = 0; i < blocks_.size(); i += 2)
        out.blocks.push_back({mixers_.empty() ? std::vector<float>() : numbers(mixers_[i / 2]->weight),
                              dense(blocks_[i]), dense(blocks_[i + 1])});
    return out;
}

int StrandMlp::reach() const { return int(mixers_.size()) * (kernel / 2); }

Tensor StrandMlp::mixed(const Tensor& x, torch::nn::Conv2d& layer, const Tensor& mask, const Tensor& like) {
    const Tensor weight = layer->weight.to(x.scalar_type());
    const Tensor around = torch::conv2d(from_rows(mask.defined() ? x * mask : x, like), weight, {},
                                        /*stride=*/1, kernel / 2, /*dilation=*/1, x.size(1));
    return to_rows(around).add_(x);
}

#ifdef WETCURL_MODEL_KERNELS
// A block adds W2 h + b2 to x. The bias is left out of x, so that the product adds to it where it lies: after
// block k `shift` (k + 1) is what x lacks, and whoever reads x adds it.
struct StrandMlp::Frozen {
    Tensor mean, share, shift;  // (C), (C) of a deviation, (blocks + 1, channels)
    Tensor lift;                // (blocks, channels): what a shift comes to where a pixel sees all around it
    Tensor first, first_bias;   // inputs filled up to a multiple of 8, as tensor cores want them
    std::vector<Tensor> in, in_bias, out, taps;  // of blocks; matrices (inputs, outputs)
    Tensor last;  // (channels + 8, outputs) times `scale`, of rows as launch_activate gives them
};

void StrandMlp::freeze() {
    const torch::NoGradGuard no_grad;
    if (body == torch::kHalf && mean_.is_cuda()) {
        auto half = [](const Tensor& x) { return x.to(torch::kHalf).contiguous(); };
        auto frozen = std::make_shared<Frozen>();
        frozen->mean = mean_.contiguous(), frozen->share = deviation_.reciprocal();
        const long inputs = mean_.size(0);
        frozen->first = half(torch::constant_pad_nd(first_->weight, {0, (8 - inputs % 8) % 8})).t();
        frozen->first_bias = half(first_->bias);
        const long channels = first_->bias.size(0);
        std::vector<Tensor> shifts{torch::zeros_like(first_->bias)};
        for (size_t i = 0; i < blocks_.size(); i += 2) {
            const auto &in = blocks_[i], &out = blocks_[i + 1];
            // Without a look around nobody else adds the shift.
            const Tensor bias = mixers_.empty() ? in->bias + in->weight.mv(shifts.back()) : in->bias;
            frozen->in.push_back(half(in->weight).t()), frozen->in_bias.push_back(half(bias));
            frozen->out.push_back(half(out->weight).t());
            shifts.push_back(shifts.back() + out->bias);
        }
        for (const auto& mixer : mixers_)
            frozen->taps.push_back(half(mixer->weight.view({channels, kernel * kernel}).t()));
        frozen->shift = torch::stack(shifts);
        std::vector<Tensor> lifts;
        for (size_t k = 0; k < mixers_.size(); ++k)
            lifts.push_back(shifts[k] * (1 + frozen->taps[k].to(torch::kFloat).sum(0)));
        if (!lifts.empty()) frozen->lift = torch::stack(lifts);
        const Tensor bias = last_->bias * scale_, coarse = half(bias), fine = half(bias - coarse);
        Tensor rest = torch::zeros({beside_activated - 2, bias.size(0)}, coarse.options());
        frozen->last = torch::cat({half((last_->weight * scale_.view({-1, 1}) / share_activated).t()),
                                   torch::stack({coarse, fine}), rest});
        frozen_ = frozen;
    }
    TorchNetwork::freeze();
}

Tensor StrandMlp::run(const Frozen& frozen, const Tensor& input) const {
    const cudaStream_t stream = c10::cuda::getCurrentCUDAStream(input.device().index());
    const Tensor image = input.contiguous();
    const long pixels = image.size(0) * image.size(2) * image.size(3);
    GridOfRows grid{int(image.size(0)), int(image.size(2)), int(image.size(3)), int(frozen.first.size(0))};
    const auto in_half = image.options().dtype(torch::kHalf);
    const Tensor rows = torch::empty({pixels, grid.channels}, in_half),
                 mask = whole_grid || mixers_.empty() ? Tensor() : torch::empty({pixels}, in_half);
    void* const there = mask.defined() ? mask.data_ptr() : nullptr;
    launch_normalise(grid, int(image.size(1)), image.data_ptr<float>(), frozen.mean.data_ptr<float>(),
                     frozen.share.data_ptr<float>(), half_reach, rows.data_ptr(), there, stream);
    Tensor x = torch::addmm(frozen.first_bias, rows, frozen.first);  // (P, channels)
    grid.channels = int(x.size(1));
    const Tensor around = mixers_.empty() ? x : torch::empty_like(x);
    for (size_t k = 0; k < frozen.in.size(); ++k) {
        if (!mixers_.empty())
            launch_mix(grid, x.data_ptr(), there, frozen.taps[k].data_ptr(),
                       frozen.shift[long(k)].data_ptr<float>(), frozen.lift[long(k)].data_ptr<float>(),
                       around.data_ptr(), stream);
        x.addmm_(at::_addmm_activation(frozen.in_bias[k], around, frozen.in[k]), frozen.out[k]);
    }
    const Tensor seen = torch::empty({pixels, grid.channels + beside_activated}, in_half);
    launch_activate(pixels, grid.channels, x.data_ptr(),
                    frozen.shift[long(frozen.in.size())].data_ptr<float>(), seen.data_ptr(), stream);
    return from_rows(at::mm(seen, frozen.last, torch::kFloat), input);
}
#else
struct StrandMlp::Frozen {};
void StrandMlp::freeze() { TorchNetwork::freeze(); }
Tensor StrandMlp::run(const Frozen&, const Tensor&) const { return {}; }
#endif

Tensor StrandMlp::forward(const Tensor& input) {
    if (frozen_) return run(*frozen_, input);
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
