// The door to LibTorch, seen from a program that does not link it: train, load and run through dlopen.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "learn/codec/network_module.h"
#include "tests/base/scratch.h"
#include "tests/training/make_pairs.h"

namespace wetcurl {
namespace {

using testing::expect_error;
using testing::Scratch;

bool torch_is_mapped() { return testing::bytes_of("/proc/self/maps").find("libtorch") != std::string::npos; }

// One test, in this order: once open, the library stays.
TEST(NetworkModule, LoadsLibTorchOnFirstUseThenTrainsAndRuns) {
    ASSERT_FALSE(torch_is_mapped());
    NetworkModule& module = network_module();
    EXPECT_TRUE(torch_is_mapped());

    Scratch scratch;
    TrainRequest request;
    request.kind = "sr";
    request.pairs = {testing::make_strand_pairs(scratch.path("pairs.h5"))};
    request.output = scratch.path("model.h5");
    request.set = {"epochs=3", "width=0.1"};
    request.threads = 1;
    long last = 0, steps = 0;
    std::string said;
    request.progress = [&](long done, long total, const std::string&) { last = done, steps = total; };
    request.log = [&](const std::string& text) { said += text; };
    module.train(request);
    EXPECT_EQ(last, steps);
    EXPECT_EQ(steps, 3 * 5);  // 3 epochs; of 6 frames one is held out
    EXPECT_NE(said.find("strand_mlp"), std::string::npos);

    const ModelCard card = module.card(request.output);
    EXPECT_EQ(card.input_channels, testing::made_static + testing::made_dynamic);
    auto network = module.load(request.output, "cpu", 1);
    EXPECT_EQ(network->card().parameters, card.parameters);

    // A grid and the same pixels as rows give the same: no strand sees another.
    const long c = card.input_channels, out = card.output_channels, pixels = 6;
    ASSERT_EQ(out, strand_outputs);
    std::mt19937 random(3);
    const auto rows = testing::uniform(random, size_t(pixels * c));
    std::vector<float> grid(rows.size()), by_rows(size_t(pixels * out)), by_grid(by_rows.size());
    for (long p = 0; p < pixels; ++p)
        for (long k = 0; k < c; ++k) grid[size_t(k * pixels + p)] = rows[size_t(p * c + k)];
    network->run(rows.data(), {pixels, c, 1, 1}, by_rows.data());
    network->run(grid.data(), {1, c, 2, 3}, by_grid.data());
    float size = 0, apart = 0;
    for (long p = 0; p < pixels; ++p)
        for (long k = 0; k < out; ++k) {
            size = std::max(size, std::abs(by_rows[size_t(p * out + k)]));
            apart = std::max(apart, std::abs(by_rows[size_t(p * out + k)] - by_grid[size_t(k * pixels + p)]));
        }
    EXPECT_GT(size, 1e-3f);
    EXPECT_LT(apart, 1e-6f * size);

    // The released network in Eq 11's place is what its layers are.
    EXPECT_FALSE(network->layers());
    const auto adhesion = module.load(WETCURL_SOURCE_DIR "/models/weights/adhesion_scene15.h5", "cpu", 1);
    const auto layers = adhesion->layers();
    ASSERT_TRUE(layers);
    const long asked = 200, inputs = layers->inputs();
    ASSERT_EQ(inputs, adhesion->card().input_channels);
    const auto particles = testing::uniform(random, size_t(asked * inputs));
    std::vector<float> answers(size_t(asked), 0.f);
    adhesion->run(particles.data(), {asked, inputs, 1, 1}, answers.data());
    EXPECT_GT(
        *std::max_element(answers.begin(), answers.end()) - *std::min_element(answers.begin(), answers.end()),
        0.1f);
    for (long k = 0; k < asked; ++k)
        EXPECT_NEAR(layers->evaluate(&particles[size_t(k * inputs)]), answers[size_t(k)], 1e-6) << k;

    // Errors keep their kind on the way through.
    expect_error(
        [&] {
            network->run(rows.data(), {pixels, c - 1, 1, 1}, by_rows.data());
        },
        {"strand_mlp", std::to_string(c - 1), std::to_string(c)});
    expect_error([&] { module.load(scratch.path("absent.h5"), "cpu", 1); }, {"absent.h5", "no such file"});
    expect_error<Misuse>([&] { module.load(request.output, "tpu", 1); }, {"tpu"});
    expect_error<Misuse>([&] { request.set = {"epoch=3"}, request.overwrite = true, module.train(request); },
                         {"epoch", "did you mean 'epochs'"});
}

}  // namespace
}  // namespace wetcurl
