// Networks to be timed.
#include "training/measured.h"

#include <torch/cuda.h>

#include "learn/inference/inference.h"
#include "models/device.h"
#include "models/registry.h"
#include "training/losses.h"
#include "training/optimiser.h"

namespace wetcurl {
namespace {

constexpr long patch = 32;  // a side that every network of codec root takes without padding

// Of a forward run on `shape`, which is of whole patches.
double operations_on(const ModelCard& card, std::array<long, 4> shape) {
    const auto [b, c, h, w] = shape;
    const double of_a_patch = operations_of(*make_model(card), torch::zeros({1, c, patch, patch}));
    return of_a_patch * double(b) * double(h * w) / double(patch * patch);
}

}  // namespace

MeasuredNetwork measured_inference(const ModelCard& card, std::array<long, 4> shape,
                                   const std::string& device, int threads) {
    const auto on = torch::dtype(torch::kFloat).device(device_named(device));
    const auto [b, c, h, w] = shape;
    const std::shared_ptr<Network> network = network_of(card, make_model(card), device, threads);
    const Tensor input = torch::rand({b, c, h, w}, on),
                 output = torch::empty({b, card.output_channels, h * card.upscale, w * card.upscale}, on);
    const bool on_device = input.is_cuda();
    if (on_device) torch::cuda::synchronize();
    return {[=] { network->run(input.data_ptr<float>(), shape, output.data_ptr<float>(), on_device); },
            operations_on(card, shape)};
}

MeasuredNetwork measured_training(const ModelCard& card, std::array<long, 4> shape, const std::string& device,
                                  int threads, bool deterministic) {
    set_threads(threads);
    choose(deterministic ? Convolutions::repeatable : Convolutions::fastest);
    const torch::Device on = device_named(device);
    const auto [b, c, h, w] = shape;
    TrainRequest request;
    request.set = {"precision='bfloat16'"};
    const Recipe recipe = read_recipe(request, Codec::root, {card.architecture});
    const std::shared_ptr<TorchNetwork> model = make_model(card);
    model->to(on);
    model->body = torch::kBFloat16;
    const auto optimiser = std::make_shared<Optimiser>(*model, recipe.weight_decay, recipe.gradient_clip);
    const std::shared_ptr<Loss> loss = make_loss(Codec::root, recipe, 0, 1, on);
    const Tensor input = torch::rand({b, c, h, w}, on), base = up(input),
                 mask = torch::ones({b, 1, 2 * h, 2 * w}, on);
    const Batch batch{input, base + 0.01 * torch::randn_like(base), base, mask, {}};
    return {[=] {
                optimiser->clear_gradients();
                loss->of(model->forward(batch.input), batch).backward();
                optimiser->step(recipe.learning_rate);  // waits: it reads the gradient's norm
            },
            3 * operations_on(card, shape)};
}

}  // namespace wetcurl
