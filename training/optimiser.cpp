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

Optimiser::Optimiser(Model& model, double weight_decay, double gradient_clip)
    : weight_decay_(weight_decay), clip_(gradient_clip) {
    torch::NoGradGuard no_grad;
    std::vector<Tensor> parts;
    for (const auto& p : model.parameters()) parts.push_back(p.detach().reshape(-1));
    weights = torch::cat(parts);
    shared = torch::zeros({weights.numel() + extras}, weights.options());
    gradient_ = shared.narrow(0, 0, weights.numel());
    first_moment = torch::zeros_like(weights);
    second_moment = torch::zeros_like(weights);
    long at = 0;
    for (auto& p : model.parameters()) {
        const Tensor found = p.detach().clone();
        const auto part = [&](const Tensor& flat) {
            return as_laid_out(flat.narrow(0, at, p.numel()), found);
        };
        p.set_data(part(weights));
        p.copy_(found);
        p.mutable_grad() = part(gradient_);
        at += p.numel();
    }
}

double Optimiser::step(double learning_rate) {
    constexpr double beta1 = 0.9, beta2 = 0.999, epsilon = 1e-8;
    torch::NoGradGuard no_grad;
    const double norm = gradient_.norm().item<double>();
    if (!std::isfinite(norm)) return norm;
    if (clip_ > 0 && norm > clip_) gradient_.mul_(clip_ / norm);
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
