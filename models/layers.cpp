// What the networks share.
#include "models/layers.h"

#include <ATen/Context.h>
#include <torch/csrc/autograd/custom_function.h>
#include <torch/nn/functional/padding.h>

#include <algorithm>
#include <cmath>

namespace wetcurl {

namespace nn = torch::nn;

int scaled_channels(int channels, double width) {
    return 8 * std::max(1, int(std::ceil(channels * width / 8)));
}

long parameter_count(const TorchNetwork& model) {
    long n = 0;
    for (const auto& p : model.parameters()) n += p.numel();
    return n;
}

// Children are registered in the order in which they run: the last gives single precision.
void TorchNetwork::freeze() {
    const auto layers = children();
    for (size_t k = 0; k < layers.size(); ++k) {
        torch::NoGradGuard no_grad;
        if (k + 1 < layers.size()) layers[k]->to(body);
        for (auto& p : layers[k]->parameters())
            if (p.is_cuda() && p.dim() == 4) p.set_data(p.contiguous(torch::MemoryFormat::ChannelsLast));
    }
}

// Variance 2 / fan_in keeps the signal through twenty layers of ReLU; LibTorch's own default loses it.
static void he_initialise(Tensor weight, Tensor bias) {
    nn::init::kaiming_normal_(weight, 0.0, torch::kFanIn, torch::kReLU);
    nn::init::zeros_(bias);
}

nn::Conv2d convolution(int in, int out, int kernel) {
    nn::Conv2d layer(nn::Conv2dOptions(in, out, kernel).padding(kernel / 2));
    he_initialise(layer->weight, layer->bias);
    return layer;
}

nn::Linear dense(int in, int out) {
    nn::Linear layer(in, out);
    he_initialise(layer->weight, layer->bias);
    return layer;
}

void set_zero(nn::Module& layer) {
    torch::NoGradGuard no_grad;
    for (auto& p : layer.parameters()) p.zero_();
}

// Of the thread, while operations_of runs.
static thread_local double* counted = nullptr;

static void count(double pixels, const Tensor& weight) {
    if (counted) *counted += 2 * pixels * double(weight.numel());
}

double operations_of(TorchNetwork& model, const Tensor& input) {
    const torch::NoGradGuard no_grad;
    double operations = 0;
    struct Counting {
        ~Counting() { counted = nullptr; }
    } until_the_end;
    counted = &operations;
    model.forward(input);
    return operations;
}

Tensor run_layer(nn::Conv2d& layer, const Tensor& x) {
    count(double(x.size(0) * x.size(2) * x.size(3)), layer->weight);
    return torch::conv2d(x, layer->weight.to(x.scalar_type()), layer->bias.to(x.scalar_type()), /*stride=*/1,
                         layer->weight.size(2) / 2);
}

// cuDNN's convolution with bias and relu, whose gradient LibTorch does not know.
struct ConvolutionRelu : torch::autograd::Function<ConvolutionRelu> {
    static std::vector<int64_t> padding(const Tensor& weight) {
        return {weight.size(2) / 2, weight.size(3) / 2};
    }
    static Tensor run(const Tensor& x, const Tensor& weight, const Tensor& bias) {
        return at::cudnn_convolution_relu(x, weight, bias, /*stride=*/{1, 1}, padding(weight),
                                          /*dilation=*/{1, 1}, /*groups=*/1);
    }
    static Tensor forward(torch::autograd::AutogradContext* context, const Tensor& x, const Tensor& weight,
                          const Tensor& bias) {
        const Tensor y = run(x, weight, bias);
        context->save_for_backward({x, weight, y});
        return y;
    }
    static torch::autograd::variable_list backward(torch::autograd::AutogradContext* context,
                                                   torch::autograd::variable_list gradients) {
        const auto saved = context->get_saved_variables();
        const Tensor &x = saved[0], &weight = saved[1], &y = saved[2];
        const Tensor passed = at::threshold_backward(gradients[0], y, 0);
        const auto [of_x, of_weight, of_bias] = at::convolution_backward(
            passed, x, weight, at::IntArrayRef({weight.size(0)}), /*stride=*/{1, 1}, padding(weight),
            /*dilation=*/{1, 1}, /*transposed=*/false, /*output_padding=*/{0, 0}, /*groups=*/1,
            {context->needs_input_grad(0), true, true});
        return {of_x, of_weight, of_bias};
    }
};

// That kernel knows no choice of what repeats its bits, and is there for 16-bit numbers.
Tensor run_relu(nn::Conv2d& layer, const Tensor& x) {
    if (!x.is_cuda() || x.scalar_type() == torch::kFloat || at::globalContext().deterministicCuDNN())
        return run_layer(layer, x).relu_();
    const Tensor weight = layer->weight.to(x.scalar_type()), bias = layer->bias.to(x.scalar_type());
    if (!torch::GradMode::is_enabled()) return ConvolutionRelu::run(x, weight, bias);
    return ConvolutionRelu::apply(x, weight, bias);
}

Tensor run_layer(nn::Linear& layer, const Tensor& rows) {
    count(double(rows.size(0)), layer->weight);
    return linear_rows(rows, layer->weight.to(rows.scalar_type()), layer->bias.to(rows.scalar_type()));
}

// Debian's LibTorch multiplies matrices with the reference BLAS (3 GFLOP/s a core here) but convolves with
// oneDNN (100): on the CPU the product is written as a 1x1 convolution, channels last, so that nothing is
// copied. With one thread LibTorch takes oneDNN only from a batch of 16 on, hence the split.
Tensor linear_rows(const Tensor& rows, const Tensor& weight, const Tensor& bias) {
    if (!rows.device().is_cpu()) {
        // Tensor cores want rows of 16 bytes: turned over, those of an odd number of inputs are.
        if (weight.size(1) % 8 == 0 || !bias.defined()) return torch::linear(rows, weight, bias);
        return torch::addmm(bias, rows, weight.t().contiguous());
    }
    constexpr long split = 16;
    const long count = rows.size(0), in = rows.size(1), out = weight.size(0);
    const long padding = (split - count % split) % split;
    const Tensor x = padding ? torch::constant_pad_nd(rows, {0, 0, 0, padding}) : rows;
    const Tensor image = x.reshape({split, -1, 1, in}).permute({0, 3, 1, 2});
    const Tensor y = torch::conv2d(image, weight.reshape({out, in, 1, 1}), bias).permute({0, 2, 3, 1});
    return y.reshape({count + padding, out}).narrow(0, 0, count);
}

Tensor doubling_rows(const Tensor& weight) {
    return weight.permute({2, 3, 1, 0}).reshape({4 * weight.size(1), -1});
}

// Differs from a call of conv_transpose2d: the 2x2 patches do not overlap, so that each pixel gives its own
// four by a matrix product. The same sums at linear_rows' speed, and right in bfloat16, where 1.13 on the CPU
// is not.
Tensor run_doubling(nn::ConvTranspose2d& layer, const Tensor& x) {
    const long b = x.size(0), h = x.size(2), w = x.size(3), out = layer->weight.size(1);
    count(double(b * h * w), layer->weight);
    const Tensor weight = doubling_rows(layer->weight).to(x.scalar_type());
    const Tensor bias = layer->bias.repeat({4}).to(x.scalar_type());
    const Tensor patches = linear_rows(to_rows(x), weight, bias).view({b, h, w, 2, 2, out});
    return patches.permute({0, 1, 3, 2, 4, 5}).reshape({b, 2 * h, 2 * w, out}).permute({0, 3, 1, 2});
}

Tensor to_rows(const Tensor& image) { return image.permute({0, 2, 3, 1}).reshape({-1, image.size(1)}); }

Tensor from_rows(const Tensor& rows, const Tensor& like) {
    return rows.view({like.size(0), like.size(2), like.size(3), rows.size(1)}).permute({0, 3, 1, 2});
}

Tensor normalised(const Tensor& rows, const Tensor& mean, const Tensor& deviation, torch::ScalarType body) {
    Tensor out = torch::empty_like(rows, rows.options().dtype(body));
    torch::div_out(out, rows - mean, deviation);
    return body == torch::kHalf ? out.clamp_(-half_reach, half_reach) : out;
}

// One axis of up().
static Tensor up_along(const Tensor& x, long axis) {
    const long n = x.size(axis);
    const Tensor last = x.narrow(axis, n - 1, 1);
    const Tensor beyond = n > 1 ? 2 * last - x.narrow(axis, n - 2, 1) : last;
    const Tensor next = torch::cat({x.narrow(axis, 1, n - 1), beyond}, axis);
    return torch::stack({x, 0.5 * (x + next)}, axis + 1).flatten(axis, axis + 1);
}

Tensor up(const Tensor& image) { return up_along(up_along(image, image.dim() - 2), image.dim() - 1); }

}  // namespace wetcurl
