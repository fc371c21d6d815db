// AdamW over one flat vector.
// Kingma and Ba 2015, Loshchilov and Hutter 2019.
#include "training/optimiser.h"

#include <cmath>

namespace wetcurl {

// A part of a flat vector with the shape of `like`: a GPU's convolutions take their weights channels last.
static Tensor as_laid_out(const Tensor& flat, const Tensor& like) {
    if (!like.is_cuda() || like.dim() != 4) return flat.view(like.sizes());
    return flat.view({like.size(0), like.size(2), like.size(3), like.size(1)}).permute({0, 3, 1, 2});
}

Optimiser::Optimiser(TorchNetwork& model, double weight_decay, double gradient_clip)
    : weight_decay_(weight_decay), clip_(gradient_clip) {
    torch::NoGradGuard no_grad;
    parameters_ = model.parameters();
    long count = 0;
    for (const auto& p : parameters_) count += p.numel();
    weights = torch::empty({count}, parameters_.front().options().requires_grad(false));
    shared = torch::zeros({count + extras}, weights.options());
    gradient_ = shared.narrow(0, 0, count);
    first_moment = torch::zeros_like(weights);
    second_moment = torch::zeros_like(weights);
    const auto values = parts_of(weights), gradients = parts_of(gradient_);
    for (size_t k = 0; k < parameters_.size(); ++k) {
        values[k].copy_(parameters_[k]);
        parameters_[k].set_data(values[k]);
        parameters_[k].mutable_grad() = gradients[k];
    }
}

std::vector<Tensor> Optimiser::parts_of(const Tensor& flat) const {
    std::vector<Tensor> parts;
    long at = 0;
    for (const auto& p : parameters_) {
        parts.push_back(as_laid_out(flat.narrow(0, at, p.numel()), p));
        at += p.numel();
    }
    return parts;
}

Tensor Optimiser::as_on_cpu(const Tensor& part) const {
    const torch::NoGradGuard no_grad;
    std::vector<Tensor> flat;
    for (const auto& p : parts_of(part)) flat.push_back(p.reshape(-1));
    return torch::cat(flat).to(torch::kCPU);
}

void Optimiser::take(Tensor& part, const Tensor& as_on_cpu) const {
    const torch::NoGradGuard no_grad;
    long at = 0;
    for (auto& p : parts_of(part)) {
        p.copy_(as_on_cpu.narrow(0, at, p.numel()).view(p.sizes()));
        at += p.numel();
    }
}

Tensor Optimiser::step(double learning_rate) {
    constexpr double beta1 = 0.9, beta2 = 0.999, epsilon = 1e-8;
    torch::NoGradGuard no_grad;
    const Tensor norm = gradient_.norm();
    if (clip_ > 0) gradient_.mul_((clip_ / norm).clamp_max(1));
    ++steps;
    first_moment.lerp_(gradient_, 1 - beta1);
    second_moment.mul_(beta2).addcmul_(gradient_, gradient_, 1 - beta2);
    const double first_bias = 1 - std::pow(beta1, double(steps)),
                 second_bias = 1 - std::pow(beta2, double(steps));
    const Tensor denominator = second_moment.sqrt().div_(std::sqrt(second_bias)).add_(epsilon);
    if (weight_decay_ > 0) weights.mul_(1 - learning_rate * weight_decay_);
    weights.addcdiv_(first_moment, denominator, -learning_rate / first_bias);
    return norm;
}

}  // namespace wetcurl
