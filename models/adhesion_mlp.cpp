// The adhesion force as a network.
// Figure 18, Eq 20.
#include "models/adhesion_mlp.h"

#include "base/network_channels.h"

namespace wetcurl {

namespace {
constexpr int sizes[] = {adhesion_inputs, 6, 5, 4, 1};
}

AdhesionMlp::AdhesionMlp() {
    for (size_t i = 0; i + 1 < std::size(sizes); ++i)
        layers_.push_back(register_module("layer" + std::to_string(i), dense(sizes[i], sizes[i + 1])));
}

Tensor AdhesionMlp::forward(const Tensor& input) {
    Tensor x = to_rows(input).to(body);
    for (size_t i = 0; i + 1 < layers_.size(); ++i) x = torch::leaky_relu(run_layer(layers_[i], x));
    return from_rows(run_layer(layers_.back(), x.to(torch::kFloat)), input);
}

std::optional<DenseLayers> AdhesionMlp::dense_layers() const {
    std::vector<float> numbers;
    for (const auto& layer : layers_)
        for (const Tensor& of_layer : {layer->weight, layer->bias}) {
            const Tensor here = of_layer.detach().to(torch::kCPU, torch::kFloat).contiguous();
            numbers.insert(numbers.end(), here.data_ptr<float>(), here.data_ptr<float>() + here.numel());
        }
    return DenseLayers({std::begin(sizes), std::end(sizes)}, std::move(numbers));
}

}  // namespace wetcurl
