// The networks: counts, shapes, layers by hand, gradients, files. One translation unit: LibTorch's headers
// are slow.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <torch/cuda.h>
#include <torch/nn/functional/conv.h>
#include <torch/utils.h>
#include <unistd.h>

#include <cstring>

#include "base/network_channels.h"
#include "models/device.h"
#include "models/model_file.h"
#include "models/registry.h"
#include "models/strand_mlp.h"
#include "models/unet_vgg19.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

namespace nn = torch::nn;
using testing::expect_error;
using testing::Scratch;

// A small card of each architecture; `width` where it scales.
ModelCard card_of(const Architecture& a, double width) {
    ModelCard card;
    card.codec = a.codec;
    card.architecture = a.name;
    card.width = a.scalable ? width : 1;
    card.output_channels = a.output_channels;
    card.upscale = a.upscale;
    card.input_channels = a.input_channels ? a.input_channels : strand_channels;
    if (a.codec == "strand") {
        for (int c = 0; c < strand_channels; ++c) {
            card.arrays["input_mean"].push_back(0.01f * float(c));
            card.arrays["input_std"].push_back(0.5f + 0.01f * float(c));
        }
        for (int c = 0; c < strand_outputs; ++c) card.arrays["output_scale"].push_back(1 / (1.0f + float(c)));
    }
    return card;
}

// The card's network with no weight left at zero.
std::shared_ptr<TorchNetwork> stirred(const ModelCard& card, uint64_t seed = 1) {
    torch::manual_seed(seed);
    auto model = make_model(card);
    torch::NoGradGuard no_grad;
    for (auto& p : model->parameters()) p.add_(0.02 * torch::randn_like(p));
    return model;
}

Tensor input_of(const ModelCard& card, long batch = 2, long side = 32) {
    torch::manual_seed(7);
    return torch::rand({batch, card.input_channels, side, side});
}

double largest(const Tensor& t) { return t.abs().max().item<double>(); }
bool same_bits(const Tensor& a, const Tensor& b) {
    const Tensor x = a.contiguous(), y = b.contiguous();
    return a.sizes() == b.sizes() && std::memcmp(x.data_ptr<float>(), y.data_ptr<float>(), x.nbytes()) == 0;
}

TEST(ParameterCounts, AreThoseOfTheEquationsAtWidthOne) {
    const long hidden = 256;
    const long strand =
        (strand_channels + 1) * hidden + 10 * (hidden + 1) * hidden + (hidden + 1) * strand_outputs;
    const std::map<std::string, long> expected = {
        {"unet_vgg19", 60031235},
        {"recursive_residual", 2366339},
        {"adhesion_mlp", 142},
        {"strand_mlp", strand},
        {"strand_depthwise", strand + 5 * 25 * hidden},
        {"strand_linear", (strand_channels + 1) * strand_outputs},
        // The first layer takes more, the last gives more; without doubling r6 is gone: 64 to 64 channels by
        // 2x2, then twice by 5x5.
        {"strand_unet_vgg19", 60031235 + 25 * 64 * (strand_channels - 3) +
                                  (25 * 64 + 1) * (strand_outputs - 3) - (4 * 64 * 64 + 64) -
                                  2 * (25 * 64 * 64 + 64)},
        {"strand_recursive_residual",
         2366339 + 25 * 64 * (strand_channels - 3) + (25 * 64 + 1) * (strand_outputs - 3)}};
    ASSERT_EQ(expected.size(), architectures().size());
    for (const auto& a : architectures())
        EXPECT_EQ(parameter_count(*make_model(card_of(a, 1))), expected.at(a.name)) << a.name;
}

TEST(Width, MultipliesChannelsAndRoundsThemUpToEight) {
    EXPECT_EQ(scaled_channels(64, 1), 64);
    EXPECT_EQ(scaled_channels(64, 0.5), 32);
    EXPECT_EQ(scaled_channels(64, 0.51), 40);
    EXPECT_EQ(scaled_channels(64, 0.001), 8);
    EXPECT_EQ(scaled_channels(256, 2), 512);
}

TEST(UnetVgg19, EveryBlockHasTheShapeOfTable1) {
    UnetVgg19 model(1);
    std::vector<std::string> seen;
    auto note = [&](const std::string& block, const Tensor& x) {
        seen.push_back(block + " " + std::to_string(x.size(2)) + "x" + std::to_string(x.size(3)) + "x" +
                       std::to_string(x.size(1)));
    };
    model.watch = note;
    torch::NoGradGuard no_grad;
    const Tensor out = model.forward(torch::rand({1, 3, 128, 128}));
    const std::vector<std::string> table = {
        "C1 128x128x64", "C2 64x64x128", "C3 32x32x256", "C4 16x16x512",  "C5 8x8x512",    "r1 8x8x64",
        "r2 16x16x64",   "r3 32x32x64",  "r4 64x64x64",  "r5 128x128x64", "r6 256x256x64", "r7 256x256x3"};
    EXPECT_EQ(seen, table);
    EXPECT_EQ(out.sizes(), (std::vector<int64_t>{1, 3, 256, 256}));
}

// Input 1..9 in a 3x3 image; a 5x5 kernel that takes 2 times the pixel itself, 10 times the one two to the
// right and 100 times the one above: out = 2 x[r][c] + 10 x[r][c+2] + 100 x[r-1][c] + 0.5, zeros outside.
TEST(Convolution, GivesWhatAHandFinds) {
    nn::Conv2d layer = convolution(1, 1, 5);
    torch::NoGradGuard no_grad;
    layer->weight.zero_();
    layer->weight[0][0][2][2] = 2;
    layer->weight[0][0][2][4] = 10;
    layer->weight[0][0][1][2] = 100;
    layer->bias.fill_(0.5);
    const Tensor x = torch::arange(1, 10).to(torch::kFloat).view({1, 1, 3, 3});
    const Tensor expected = torch::tensor({32.5, 4.5, 6.5, 168.5, 210.5, 312.5, 504.5, 516.5, 618.5})
                                .to(torch::kFloat)
                                .view({1, 1, 3, 3});
    EXPECT_TRUE(torch::equal(run_layer(layer, x), expected)) << run_layer(layer, x);
}

TEST(Doubling, IsTheTransposedConvolution) {
    torch::manual_seed(3);
    nn::ConvTranspose2d layer(nn::ConvTranspose2dOptions(5, 8, 2).stride(2));
    const Tensor x = torch::randn({2, 5, 7, 6});
    const Tensor expected = torch::conv_transpose2d(x, layer->weight, layer->bias, 2);
    ASSERT_GT(largest(expected), 0.1);
    EXPECT_LT(largest(run_doubling(layer, x) - expected), 1e-5);  // sums of five products, rounded apart
}

TEST(LinearRows, IsTheMatrixProductForAnyNumberOfRowsAndThreads) {
    torch::manual_seed(4);
    const Tensor weight = torch::randn({9, 20}), bias = torch::randn({9});
    for (int threads : {2, 1})
        for (long rows : {1, 15, 16, 33, 160}) {
            torch::set_num_threads(threads);
            const Tensor x = torch::randn({rows, 20});
            const Tensor expected =
                torch::linear(x.to(torch::kDouble), weight.to(torch::kDouble), bias.to(torch::kDouble));
            ASSERT_GT(largest(expected), 1);
            EXPECT_LT(largest(linear_rows(x, weight, bias) - expected), 1e-5)
                << rows << " rows, " << threads << " threads";
        }
}

TEST(StrandMlp, IsAStackOfOneByOneConvolutions) {
    const ModelCard card = card_of(*find_architecture("strand_mlp"), 0.1);
    auto model = stirred(card);
    const Tensor x = torch::rand({2, strand_channels, 3, 5});
    torch::NoGradGuard no_grad;
    auto p = model->named_parameters();
    auto conv = [&](const std::string& name, const Tensor& t) {
        const Tensor w = p[name + ".weight"];
        return torch::conv2d(t, w.view({w.size(0), w.size(1), 1, 1}), p[name + ".bias"]);
    };
    auto plane = [&](const std::string& name) {
        return torch::tensor(card.arrays.at(name)).view({1, -1, 1, 1});
    };
    Tensor h = conv("first", (x - plane("input_mean")) / plane("input_std"));
    for (int b = 0; b < 5; ++b) {
        const std::string block = "block" + std::to_string(b);
        h = h + conv(block + "_1", torch::relu(conv(block + "_0", h)));
    }
    const Tensor expected = conv("last", torch::relu(h)) * plane("output_scale");
    ASSERT_GT(largest(expected), 0.02);  // stirred: one weight of the last layer
    EXPECT_LT(largest(model->forward(x) - expected), 1e-5 * largest(expected));
}

TEST(AdhesionMlp, IsWhatItsDenseLayersGiveWithoutLibTorch) {
    for (const auto& a : architectures()) {
        const auto model = stirred(card_of(a, 0.05));
        const auto layers = model->dense_layers();
        ASSERT_EQ(layers.has_value(), a.name == "adhesion_mlp") << a.name;
        if (!layers) continue;
        EXPECT_EQ(layers->inputs(), a.input_channels);
        torch::NoGradGuard no_grad;
        const Tensor x = torch::randn({1000, a.input_channels, 1, 1}), y = model->forward(x);
        ASSERT_GT(largest(y), 0.1);
        ASSERT_LT(y.min().item<double>(), 0);
        for (long k = 0; k < x.size(0); ++k)
            EXPECT_NEAR(layers->evaluate(x[k].data_ptr<float>()), y[k].item<float>(), 1e-6) << k;
    }
}

TEST(StrandDepthwise, StartsAsTheNetworkThatSeesNoNeighbours) {
    torch::NoGradGuard no_grad;
    const ModelCard alone = card_of(*find_architecture("strand_mlp"), 0.1),
                    among = card_of(*find_architecture("strand_depthwise"), 0.1);
    auto mlp = stirred(alone);
    auto depthwise = make_model(among);
    for (auto& p : depthwise->named_parameters())
        if (p.key().find("mixer") == std::string::npos) p.value().copy_(mlp->named_parameters()[p.key()]);
    const Tensor x = torch::rand({2, strand_channels, 7, 5}), expected = mlp->forward(x);
    ASSERT_GT(largest(expected), 0.02);
    EXPECT_EQ(largest(depthwise->forward(x) - expected), 0);
}

// Five looks of two pixels each way: a strand is seen ten pixels away, not eleven; an empty pixel not at all.
TEST(StrandDepthwise, SeesStrandsUpToTenPixelsAwayAndNoEmptyPixels) {
    torch::NoGradGuard no_grad;
    const ModelCard card = card_of(*find_architecture("strand_depthwise"), 0.1);
    auto model = stirred(card);
    for (auto& p : model->named_parameters())  // so that ten pixels on it is more than rounding
        if (p.key().find("mixer") != std::string::npos) p.value().mul_(20);
    Tensor x = torch::rand({1, strand_channels, 1, 24});
    const Tensor before = model->forward(x);
    x.select(3, 0).add_(1);
    Tensor moved = (model->forward(x) - before).abs().amax(1).flatten();  // (24)
    EXPECT_GT(moved[0].item<float>(), 1e-3);
    EXPECT_GT(moved[10].item<float>(), 1e-6);
    EXPECT_EQ(largest(moved.narrow(0, 11, 13)), 0);
    // Without its strand, pixel 0 is like the border: what is left is what a grid without it gives.
    x.select(3, 0).zero_();
    const Tensor without = model->forward(x.narrow(3, 1, 23));
    EXPECT_LT(largest(model->forward(x).narrow(3, 1, 23) - without), 1e-5 * largest(without));
}

TEST(EveryNetwork, GivesTheSameInChannelsLast) {
    torch::NoGradGuard no_grad;
    for (const auto& a : architectures()) {
        const ModelCard card = card_of(a, 0.125);
        auto model = stirred(card);
        const Tensor x = input_of(card), expected = model->forward(x);
        ASSERT_GT(largest(expected), 1e-2) << a.name;
        const Tensor found = model->forward(x.contiguous(torch::MemoryFormat::ChannelsLast));
        EXPECT_LT(largest(found - expected), 1e-4 * largest(expected)) << a.name;
    }
}

// A bfloat16 has 8 bits: 0.4 % a rounding, which grows as a walk over the layers: to 0.6 % over those that
// are released, to 1.2 % over the deepest. Without AVX-512 LibTorch's convolutions sum in bfloat16 too, to
// 2.3 % over the deepest; `infer` computes in single precision on such processors.
TEST(EveryNetwork, AgreesWithItselfInBfloat16) {
    torch::NoGradGuard no_grad;
    for (const auto& a : architectures()) {
        const ModelCard card = card_of(a, 0.125);
        auto model = stirred(card);
        const Tensor x = input_of(card), base = a.codec == "root" ? up(x) : torch::zeros({1});
        const Tensor expected = model->forward(x) - base;
        model->body = torch::kBFloat16;
        const Tensor found = model->forward(x) - base;
        ASSERT_EQ(found.sizes(), expected.sizes()) << a.name;
        ASSERT_GT(largest(expected), 1e-2) << a.name;
        const bool released = a.name == "strand_depthwise" || a.name == "strand_mlp";
        const double deepest = __builtin_cpu_supports("avx512bw") ? 0.015 : 0.03;
        EXPECT_LT((found - expected).norm().item<double>(),
                  (released ? 0.01 : deepest) * expected.norm().item<double>())
            << a.name;
        EXPECT_GT(largest(found - expected), 0) << a.name << ": nothing ran in bfloat16";
    }
}

TEST(EveryNetwork, FrozenGivesTheSameBits) {
    torch::NoGradGuard no_grad;
    for (const auto& a : architectures()) {
        const ModelCard card = card_of(a, 0.125);
        auto model = stirred(card);
        const Tensor x = input_of(card);
        model->body = torch::kBFloat16;
        const Tensor expected = model->forward(x);
        model->freeze();
        EXPECT_EQ(model->parameters().front().scalar_type(),
                  model->children().size() > 1 ? torch::kBFloat16 : torch::kFloat)
            << a.name;
        EXPECT_EQ(model->parameters().back().scalar_type(), torch::kFloat) << a.name;
        EXPECT_TRUE(torch::equal(model->forward(x), expected)) << a.name;
    }
}

TEST(Operations, AreThoseOfTheLayersThatRun) {
    ModelCard card = card_of(*find_architecture("strand_mlp"), 1);
    // 256 channels, ten layers between the first and the last.
    const double a_pixel = 2.0 * (strand_channels * 256 + 10 * 256 * 256 + 256 * strand_outputs);
    EXPECT_EQ(operations_of(*make_model(card), input_of(card, 1, 4)), 16 * a_pixel);
    // By hand, of `recursive_residual`: 5x5 convolutions of 8 channels, at 32 x 32 the first and twenty, at
    // 64 x 64 three and the last.
    card = card_of(*find_architecture("recursive_residual"), 0.125);
    const double by_hand = 2.0 * 25 * 1024 * (3 * 8 + 20 * 64 + 4 * (3 * 64 + 8 * 3));
    EXPECT_EQ(operations_of(*make_model(card), input_of(card, 1, 32)), by_hand);
    // Twice as many pixels of either kind, twice the work.
    card = card_of(*find_architecture("unet_vgg19"), 0.125);
    const auto unet = make_model(card);
    EXPECT_EQ(operations_of(*unet, input_of(card, 2, 32)), 2 * operations_of(*unet, input_of(card, 1, 32)));
    EXPECT_EQ(operations_of(*unet, input_of(card, 1, 64)), 4 * operations_of(*unet, input_of(card, 1, 32)));
}

// Kernels of our own, and LibTorch's, which round more often.
TEST(StrandMlp, FrozenOnADeviceIsWhatItWas) {
    if (!torch::cuda::is_available()) GTEST_SKIP() << "SKIP: no CUDA device";
    const torch::NoGradGuard no_grad;
    for (const char* name : {"strand_mlp", "strand_depthwise"}) {
        const ModelCard card = card_of(*find_architecture(name), 0.3);
        auto model = stirred(card), frozen = stirred(card);
        for (const auto& m : {model, frozen}) m->to(torch::kCUDA), m->body = torch::kHalf;
        frozen->freeze();
        for (const bool holes : {false, true}) {
            torch::manual_seed(3);
            Tensor x = torch::rand({3, strand_channels, 19, 37}, torch::kCUDA);
            if (holes) x *= torch::rand({3, 1, 19, 37}, torch::kCUDA).gt(0.3);
            model->whole_grid = frozen->whole_grid = !holes;
            const Tensor expected = model->forward(x), found = frozen->forward(x);
            ASSERT_EQ(found.sizes(), expected.sizes());
            EXPECT_LT((found - expected).norm().item<double>(), 0.004 * expected.norm().item<double>())
                << name << holes;
            // What it looks at matters.
            frozen->whole_grid = true;
            const double change = (frozen->forward(x) - found).norm().item<double>();
            EXPECT_EQ(change > 0.02 * found.norm().item<double>(),
                      holes && name == std::string("strand_depthwise"))
                << name << holes;
        }
    }
}

TEST(StrandNetworks, OnADeviceInHalfPrecisionStayFiniteForAnyInput) {
    if (!torch::cuda::is_available()) GTEST_SKIP() << "SKIP: no CUDA device";
    const torch::NoGradGuard no_grad;
    for (const auto& a : architectures()) {
        if (a.codec != "strand") continue;
        auto model = stirred(card_of(a, 1));
        model->to(torch::kCUDA);
        model->body = torch::kHalf;
        model->freeze();
        torch::manual_seed(6);
        for (const double size : {1.0, 1e4, 1e9}) {
            const Tensor x = size * torch::randn({1, strand_channels, 24, 24}, torch::kCUDA);
            EXPECT_TRUE(torch::isfinite(model->forward(x)).all().item<bool>()) << a.name << " " << size;
        }
    }
}

TEST(Up, KeepsEvenPixelsAveragesOddOnesAndExtrapolatesTheLast) {
    const Tensor x = torch::tensor({1.0f, 5.0f, 2.0f}).view({1, 1, 1, 3});
    const Tensor row = up(x)[0][0][0];
    EXPECT_TRUE(torch::equal(row, torch::tensor({1.0f, 3.0f, 5.0f, 3.5f, 2.0f, 0.5f}))) << row;
    torch::manual_seed(2);
    const Tensor image = torch::rand({2, 3, 4, 6}), twice = up(image);
    EXPECT_EQ(twice.sizes(), (std::vector<int64_t>{2, 3, 8, 12}));
    const auto even = torch::indexing::Slice(torch::indexing::None, torch::indexing::None, 2);
    EXPECT_TRUE(torch::equal(twice.index({"...", even, even}), image));
}

TEST(Up, ReproducesAPlaneToItsBorder) {
    auto plane = [](long h, long w, double step) {
        const Tensor y = torch::arange(h).to(torch::kFloat).view({h, 1}) * step,
                     x = torch::arange(w).to(torch::kFloat) * step;
        return (0.25 + 2 * y - 3 * x).view({1, 1, h, w});
    };
    EXPECT_LT(largest(up(plane(5, 4, 1)) - plane(10, 8, 0.5)), 1e-6);
    EXPECT_TRUE(torch::equal(up(torch::full({1, 1, 1, 1}, 3.0f)), torch::full({1, 1, 2, 2}, 3.0f)));
}

TEST(EveryNetwork, BeginsAsTheBaseBecauseItsLastLayerIsZero) {
    torch::NoGradGuard no_grad;
    for (const auto& a : architectures()) {
        if (a.codec == "adhesion") continue;  // it has no base
        const ModelCard card = card_of(a, 0.125);
        const Tensor x = input_of(card, 1, 40), found = make_model(card)->forward(x);
        const Tensor base = a.codec == "root" ? up(x) : torch::zeros({1, strand_outputs, 40, 40});
        EXPECT_TRUE(same_bits(found, base)) << a.name;
    }
}

TEST(RootNetworks, TakeAnySizeOfImage) {
    torch::NoGradGuard no_grad;
    for (const auto& a : architectures())
        if (a.codec == "root") {
            auto model = stirred(card_of(a, 0.1));
            const Tensor x = torch::rand({1, 3, 20, 33}), out = model->forward(x);
            EXPECT_EQ(out.sizes(), (std::vector<int64_t>{1, 3, 40, 66})) << a.name;
            EXPECT_GT(largest(out - up(x)), 1e-3) << a.name;
        }
}

TEST(StrandImage, TakesAnyGridAndKnowsNothingOfEmptyPixels) {
    torch::NoGradGuard no_grad;
    for (const char* name : {"strand_unet_vgg19", "strand_recursive_residual"}) {
        ModelCard card = card_of(*find_architecture(name), 0.1);
        auto model = stirred(card);
        Tensor x = torch::rand({1, strand_channels, 20, 33});
        x.narrow(3, 10, 2).zero_();
        const Tensor out = model->forward(x);
        EXPECT_EQ(out.sizes(), (std::vector<int64_t>{1, strand_outputs, 20, 33})) << name;
        EXPECT_GT(largest(out), 1e-3) << name;
        // Another mean would move what comes in as something, and does not move what comes in as nothing.
        model->whole_grid = true;
        EXPECT_GT(largest(model->forward(x) - out), 1e-4) << name;
        x.zero_();
        model->whole_grid = false;
        const Tensor empty = model->forward(x);
        card.arrays["input_mean"].assign(strand_channels, 0.4f);
        EXPECT_TRUE(same_bits(stirred(card)->forward(x), empty)) << name;
    }
}

TEST(EveryNetwork, GradientReachesEveryWeight) {
    for (const auto& a : architectures()) {
        const ModelCard card = card_of(a, 0.125);
        auto model = stirred(card);
        // 64 pixels leave 4 at the bottom of the U: each tap of a 5x5 kernel meets one.
        const Tensor out = model->forward(input_of(card, 2, 64));
        (out * torch::randn_like(out)).sum().backward();
        long silent = 0;
        for (const auto& p : model->named_parameters()) {
            ASSERT_TRUE(p.value().grad().defined()) << a.name << " " << p.key();
            EXPECT_TRUE(torch::isfinite(p.value().grad()).all().item<bool>()) << a.name << " " << p.key();
            EXPECT_GT(largest(p.value().grad()), 0) << a.name << " " << p.key();
            silent += p.value().grad().eq(0).sum().item<long>();
        }
        // A ReLU that is off for the whole batch silences its weights: a few may.
        EXPECT_LT(double(silent), 0.25 * double(parameter_count(*model))) << a.name;
    }
}

// Layers in one kernel on the device have gradients of their own.
TEST(EveryNetwork, OnADeviceHasTheSameGradientsByItsFastestKernels) {
    if (!torch::cuda::is_available()) GTEST_SKIP() << "SKIP: no CUDA device";
    for (const auto& a : architectures()) {
        const ModelCard card = card_of(a, 0.125);
        const Tensor x = input_of(card).cuda();
        auto gradients = [&](Convolutions how) {
            choose(how);
            auto model = stirred(card);
            model->to(torch::kCUDA);
            model->body = torch::kBFloat16;
            const Tensor out = model->forward(x);
            torch::manual_seed(5);
            (out * torch::rand(out.sizes()).to(out.device())).sum().backward();
            std::vector<Tensor> parts;
            for (const auto& p : model->parameters()) parts.push_back(p.grad().flatten().cpu());
            return torch::cat(parts);
        };
        const Tensor expected = gradients(Convolutions::repeatable), found = gradients(Convolutions::fastest);
        EXPECT_LT((found - expected).norm().item<double>(), 0.05 * expected.norm().item<double>()) << a.name;
    }
}

TEST(Registry, NamesWhatIsAllowed) {
    EXPECT_EQ(architecture_for("", "strand", 1).name, "strand_mlp");
    EXPECT_EQ(architecture_for("", "root", 1).name, "unet_vgg19");
    expect_error<Misuse>([] { architecture_for("unet_vgg16", "root", 1); },
                         {"unet_vgg16", "did you mean 'unet_vgg19'"});
    expect_error<Misuse>([] { architecture_for("strand_mlp", "root", 1); },
                         {"strand_mlp", "codec root", "recursive_residual"});
    expect_error<Misuse>([] { architecture_for("adhesion_mlp", "adhesion", 0.5); },
                         {"width", "adhesion_mlp"});
}

TEST(Device, IsNamedOrRefused) {
    EXPECT_TRUE(device_named("cpu").is_cpu());
    for (const char* wrong : {"", "gpu", "cuda:", "cuda:x", "cuda:-1", "cpu:0"})
        expect_error<Misuse>([&] { device_named(wrong); }, {"allowed cpu, cuda, cuda:N"});
    expect_error([] { device_named("cuda:999"); }, {"cuda:999", "CUDA devices"});
}

// ---- files ----

TEST(ModelFile, GivesBackCardAndBits) {
    Scratch scratch;
    for (const auto& a : architectures()) {
        ModelCard card = card_of(a, 0.125);
        card.numbers["validation_mm"] = 1.25;
        card.recipe = "epochs = 3\n";
        card.inputs = "pairs.h5 0123";
        card.low_substeps = a.codec == "adhesion" ? 0 : 4;
        auto model = stirred(card);
        const std::string path = scratch.path(a.name);
        save_model(path, card, *model, false);
        const auto [read, loaded] = load_model(path);
        EXPECT_EQ(read.architecture, a.name);
        EXPECT_EQ(read.codec, a.codec);
        EXPECT_EQ(read.width, card.width);
        EXPECT_EQ(read.parameters, parameter_count(*model));
        EXPECT_EQ(read.low_substeps, card.low_substeps);
        EXPECT_EQ(read.numbers, card.numbers);
        EXPECT_EQ(read.arrays, card.arrays);
        EXPECT_EQ(read.recipe, card.recipe);
        EXPECT_EQ(read.inputs, card.inputs);
        torch::NoGradGuard no_grad;
        const Tensor x = input_of(card), expected = model->forward(x);
        ASSERT_GT(largest(expected), 1e-2);
        EXPECT_TRUE(same_bits(loaded->forward(x), expected)) << a.name;
    }
}

constexpr const char* fresh_flag = "--answer";

// Each model's answer to the usual input, as raw bytes beside it.
void answer(const std::vector<std::string>& models, const std::string& suffix) {
    set_threads(1);  // their number orders the sums
    torch::NoGradGuard no_grad;
    for (const auto& path : models) {
        const auto [card, model] = load_model(path);
        const Tensor y = model->forward(input_of(card)).contiguous();
        std::ofstream(path + suffix, std::ios::binary)
            .write(reinterpret_cast<const char*>(y.data_ptr<float>()), long(y.nbytes()));
    }
}

TEST(ModelFile, GivesTheSameBitsInAFreshProcess) {
    Scratch scratch;
    std::vector<std::string> paths;
    for (const auto& a : architectures()) {
        const ModelCard card = card_of(a, 0.125);
        paths.push_back(scratch.path(a.name));
        save_model(paths.back(), card, *stirred(card, 5), false);
    }
    const pid_t child = fork();
    if (child == 0) {
        std::vector<char*> arguments{const_cast<char*>("test_models"), const_cast<char*>(fresh_flag)};
        for (auto& path : paths) arguments.push_back(path.data());
        arguments.push_back(nullptr);
        execv("/proc/self/exe", arguments.data());
        _exit(127);
    }
    int status = 0;
    waitpid(child, &status, 0);
    ASSERT_EQ(status, 0);
    answer(paths, ".here");
    for (const auto& path : paths) {
        const std::string there = testing::bytes_of(path + ".there");
        ASSERT_GT(there.size(), 1000u) << path;
        EXPECT_TRUE(there == testing::bytes_of(path + ".here")) << path;
    }
}

class BadModelFile : public ::testing::Test {
  protected:
    BadModelFile()
        : card(card_of(*find_architecture("adhesion_mlp"), 1)),
          model(stirred(card)),
          path(scratch.path("m.h5")) {
        save_model(path, card, *model, false);
    }
    // A file as save_model writes it, but for what `change` does to the card and to the weights.
    void write(const std::function<void(H5Writer&)>& weights, ModelCard c, int version = model_version,
               const char* format = model_format, double parameters = 142) {
        H5Writer file(path, format, version, true);
        file.attribute("codec", c.codec);
        file.attribute("architecture", c.architecture);
        file.attribute("width", c.width);
        file.attribute("input_channels", double(c.input_channels));
        file.attribute("output_channels", double(c.output_channels));
        file.attribute("upscale", double(c.upscale));
        file.attribute("parameters", parameters);
        file.attribute("recipe", c.recipe);
        file.attribute("inputs", c.inputs);
        weights(file);
        file.commit();
    }
    void expect_refused(std::initializer_list<std::string> parts) {
        expect_error([&] { load_model(path); }, parts);
        expect_error([&] { load_model(path); }, {path});
    }
    std::function<void(H5Writer&)> all = [&](H5Writer& f) { write_weights(f, *model); };

    Scratch scratch;
    ModelCard card;
    std::shared_ptr<TorchNetwork> model;
    std::string path;
};

TEST_F(BadModelFile, WrittenByHandUnchangedLoads) {
    write(all, card);
    EXPECT_EQ(load_model(path).first.parameters, 142);
}
TEST_F(BadModelFile, Missing) {
    std::filesystem::remove(path);
    expect_refused({"no such file"});
}
TEST_F(BadModelFile, EmptyOrText) {
    scratch.file("m.h5", "");
    expect_refused({"empty"});
    scratch.file("m.h5", "weights = 12\n");
    expect_refused({"found no HDF5 file"});
}
TEST_F(BadModelFile, CutShort) {
    const auto size = std::filesystem::file_size(path);
    for (auto part : {size / 4, size / 2, size - 100}) {
        save_model(path, card, *model, true);
        std::filesystem::resize_file(path, part);
        expect_refused({});
    }
}
TEST_F(BadModelFile, ForeignOrNewer) {
    write(all, card, model_version, "wetcurl run");
    expect_refused({"found a 'wetcurl run' file", "'wetcurl model'"});
    write(all, card, model_version + 1);
    expect_refused({"found version 2", "newer"});
}
TEST_F(BadModelFile, WeightThatIsNotFinite) {
    for (float bad : {std::nanf(""), INFINITY}) {
        torch::NoGradGuard no_grad;
        model->parameters()[2][1][1] = bad;
        save_model(path, card, *model, true);
        expect_refused({"layer1.weight", "finite"});
    }
}
TEST_F(BadModelFile, WeightsThatDoNotFit) {
    write([](H5Writer&) {}, card);
    expect_refused({"weights/", "missing"});
    auto extra = [&](H5Writer& f) {
        all(f);
        f.write("weights/layer9.bias", std::vector<float>{1});
    };
    write(extra, card);
    expect_refused({"layer9.bias", "no layer"});
    auto other_shape = [&](H5Writer& f) { f.write("weights/layer0.weight", std::vector<float>(72)); };
    write(other_shape, card);
    expect_refused({"layer0.weight", "shape", "(6, 12)"});
    write(all, card, model_version, model_format, 143);
    expect_refused({"143 parameters"});
}
TEST_F(BadModelFile, CardThatCannotBe) {
    auto with = [&](auto change) {
        ModelCard c = card;
        change(c);
        write(all, c);
    };
    with([](ModelCard& c) { c.architecture = "resnet"; });
    expect_refused({"architecture 'resnet'"});
    with([](ModelCard& c) { c.codec = "root"; });
    expect_refused({"codec 'root'"});
    with([](ModelCard& c) { c.width = 1e9; });
    expect_refused({"width", "allowed"});
    with([](ModelCard& c) { c.input_channels = 2000000000; });
    expect_refused({"input_channels", "allowed"});
    with([](ModelCard& c) { c.upscale = 2; });
    expect_refused({"upscale 2"});
    with([](ModelCard& c) { c.input_channels = 13; });
    expect_refused({"13 input"});
}
TEST_F(BadModelFile, NormalisationThatDoesNotFit) {
    card = card_of(*find_architecture("strand_mlp"), 0.1);
    model = stirred(card);
    card.arrays["input_std"].pop_back();
    save_model(path, card, *model, true);
    expect_refused({"input_std", std::to_string(strand_channels - 1), std::to_string(strand_channels)});
}
TEST_F(BadModelFile, NormalisationThatIsMissing) {
    for (const char* name : {"input_mean", "input_std", "output_scale"}) {
        card = card_of(*find_architecture("strand_mlp"), 0.1);
        model = stirred(card);
        card.arrays.erase(name);
        save_model(path, card, *model, true);
        expect_refused({std::string("array '") + name + "' is missing"});
        expect_error([&] { read_card(path); }, {path, name});
    }
}
TEST_F(BadModelFile, IsNotOverwrittenUnasked) {
    const std::string before = testing::bytes_of(path);
    expect_error([&] { save_model(path, card, *model, false); }, {path, "--overwrite"});
    EXPECT_TRUE(before == testing::bytes_of(path));
}

}  // namespace
}  // namespace wetcurl

int main(int argc, char** argv) {
    if (argc > 1 && std::string(argv[1]) == wetcurl::fresh_flag) {
        wetcurl::answer({argv + 2, argv + argc}, ".there");
        return 0;
    }
    wetcurl::set_threads(1);  // small tensors: a second one would only wait
    ::testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
