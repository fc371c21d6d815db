// Learned strands: codec and network behind one object, on the CPU and on the GPU.
#include <gtest/gtest.h>
#include <torch/cuda.h>
#include <torch/utils.h>

#include "learn/codec/learned_strands.h"
#include "learn/codec/lock_grid.h"
#include "learn/inference/inference.h"
#include "models/model_file.h"
#include "models/registry.h"
#include "tests/learn/hair.h"
#ifdef WETCURL_NETWORKS_ON_DEVICE
#include <c10/cuda/CUDACachingAllocator.h>

#include "base/device_buffer.h"
#include "learn/inference/device_strands.h"
#endif

namespace wetcurl {
namespace {

using testing::curly_groom;
using testing::expect_error;
using testing::Scratch;

// A network of small random weights that moves strands by some millimetres.
std::string made_model(const std::string& path, const char* architecture, int inputs,
                       const char* target = "strands") {
    ModelCard card;
    card.codec = "strand", card.architecture = architecture, card.target = target;
    card.width = 0.25;
    card.input_channels = inputs, card.output_channels = strand_outputs;
    card.arrays["input_mean"].assign(size_t(inputs), 0);
    card.arrays["input_std"].assign(size_t(inputs), 1);
    // Accelerations come in tens: a trained network's deviations know that.
    constexpr int motion = in_input(dynamic_layout.gravity).first;
    if (inputs > motion) std::fill_n(card.arrays["input_std"].begin() + motion, inputs - motion, 10.0f);
    card.arrays["output_scale"].assign(strand_outputs, 1e-2f);  // of strands of 0.2 m: 2 mm
    torch::manual_seed(4);
    auto model = make_model(card);
    {
        const torch::NoGradGuard no_grad;
        for (auto& p : model->parameters()) p.add_(0.05 * torch::randn_like(p));
    }
    save_model(path, card, *model, true);
    return path;
}

struct Swaying {
    Groom high = curly_groom({}), low = coarsened(high, 2);
    std::vector<float> saturation = std::vector<float>(high.rest.points.size(), 0.7f);
    Strands in = low.rest, out = high.rest;

    StrandCodec codec(double fps = history_fps) const {
        HairTraits traits;
        traits.fps = fps;
        return StrandCodec(high, low, saturation, nullptr, false, traits);
    }
    // The low-resolution strands of a frame, at their place.
    HeadWindow take(int f) {
        HeadWindow heads;
        heads.before = testing::head_at(f - 1), heads.now = testing::head_at(f),
        heads.after = testing::head_at(f + 1), heads.inner = f > 0;
        Strands swayed = low.rest;
        for (int s = 0; s < in.count; ++s)
            for (int i = 0; i < in.particles; ++i)
                swayed.at(s, i) += Vec3f{2e-3f * float(i) * float(std::sin(0.5 * f + s)), 0, 0};
        const Strands placed = testing::moved(swayed, heads.now);
        std::copy(placed.points.begin(), placed.points.end(), in.points.begin());  // which is bound
        return heads;
    }
};

constexpr int inputs = strand_channels;

TEST(LearnedStrands, AreWhatCodecAndLibTorchsNetworkGive) {
    Scratch scratch;
    for (const auto& [architecture, fps] : {std::pair{"strand_depthwise", 24},
                                            {"strand_depthwise", 60},
                                            {"strand_mlp", 24},
                                            {"strand_linear", 24}}) {
        const std::string model = made_model(scratch.path("m.h5"), architecture, inputs);
        Swaying hair;
        auto learned = learned_strands(load_network(model, "cpu", 1, Body::single_precision), hair.codec(fps),
                                       Body::single_precision);
        auto network = load_network(model, "cpu", 1, Body::single_precision);
        StrandCodec codec = hair.codec(fps);
        learned->bind(hair.in.points.data(), hair.out.points.data());
        std::vector<float> input(size_t(inputs) * codec.pixels()),
            answer(size_t(strand_outputs) * codec.pixels());
        std::copy(codec.fixed().begin(), codec.fixed().end(), input.begin());
        std::vector<std::vector<float>> before;  // the oldest first
        const size_t averaged = size_t(codec.averaged());
        ASSERT_EQ(averaged, fps == 60 ? 4u : 2u);
        for (int f = 0; f < 10; ++f) {
            const HeadWindow heads = hair.take(f);
            learned->run(heads);
            codec.dynamic(hair.in, heads, input.data() + codec.fixed().size());
            network->run(input.data(), {1, inputs, codec.height(), codec.width()}, answer.data());
            const std::vector<float> seen = learned->inputs();
            ASSERT_EQ(seen.size(), codec.pixel_of().size() * inputs);
            for (size_t k = 0; k < seen.size(); ++k)
                ASSERT_EQ(seen[k], input[k % inputs * codec.pixels() + size_t(codec.pixel_of()[k / inputs])]);
            // Before the first frame, all was as in it.
            before.resize(averaged, answer);
            before.erase(before.begin()), before.push_back(answer);
            std::vector<float> mean(answer.size(), 0);
            for (const auto& then : before)
                for (size_t k = 0; k < mean.size(); ++k) mean[k] += then[k] / float(averaged);
            Strands expected;
            codec.decode(mean.data(), heads.now, expected, most_length_rounds);
            EXPECT_LT(testing::largest_distance(hair.out, expected), 2e-6) << architecture << ' ' << f;
            EXPECT_GT(testing::largest_distance(learned->base(heads.now), expected), 1e-3);
        }
    }
}

TEST(LearnedStrands, BeginAnewAndStayOutsideTheHead) {
    Scratch scratch;
    const std::string model = made_model(scratch.path("m.h5"), "strand_depthwise", inputs);
    Swaying hair;
    auto learned = learned_strands(load_network(model, "cpu", 1), hair.codec());
    const std::vector<float> edges = hair.codec().edges();
    learned->bind(hair.in.points.data(), hair.out.points.data());
    std::vector<Strands> shown;
    for (int f = 0; f < 4; ++f) {
        learned->run(hair.take(f));
        shown.push_back(hair.out);
    }
    // A new run begins without a past.
    learned->restart();
    learned->run(hair.take(0));
    EXPECT_EQ(testing::largest_distance(hair.out, shown[0]), 0);
    // Out of what is attached to the head, roots apart, and what that tears is led around it.
    learned->keep_outside({{Sphere{0.12}}, std::vector<float>(hair.high.rest.points.size(), 0)});
    const HeadWindow heads = hair.take(1);
    learned->run(heads);
    int held = 0, led = 0;
    for (int s = 0; s < hair.out.count; ++s)
        for (int i = 1; i < hair.out.particles; ++i) {
            const double away = norm(heads.now.inverse(cast<double>(hair.out.at(s, i))));
            EXPECT_GT(away, 0.12 - 1e-5);
            held += away < 0.12 + 1e-5;
            if (i == 1) continue;  // from a root within the ball
            const float most = torn_lengths * edges[size_t(s * hair.out.particles + i)],
                        edge = norm(hair.out.at(s, i) - hair.out.at(s, i - 1));
            EXPECT_LT(edge, 1.05 * most);
            led += edge > 0.99 * most;
        }
    EXPECT_GT(held, 100);
    EXPECT_GT(led, 10);
    expect_error([&] { learned->keep_outside({{Sphere{0.1}}, {0, 0}}); }, {"2 depths", "3200"});
    expect_error([&] { learned->bind(nullptr, nullptr, true); }, {"CUDA", "CPU"});
    expect_error(
        [&] {
            learned_strands(load_network(made_model(scratch.path("old.h5"), "strand_mlp", 163), "cpu", 1),
                            hair.codec());
        },
        {"strand_mlp", "163", std::to_string(inputs)});
}

TEST(LearnedStrands, AreDrawnTogetherAsLocksAre) {
    Scratch scratch;
    for (const char* architecture : {"strand_depthwise", "strand_unet_vgg19"}) {
        const std::string model = made_model(scratch.path("m.h5"), architecture, inputs, "displayed");
        Swaying hair;
        const StrandCodec codec = hair.codec();
        const LockTerms terms{
            .reach = 0.015f, .coherence = 0.01f, .stretch = 0.05f, .sweeps = {1.2f, 0.8f}, .frames = 2};
        LockGrid locks(terms, codec.lanes(), codec.particles(), codec.edges(), hair.saturation);
        auto plain = learned_strands(load_network(model, "cpu", 1), hair.codec()),
             drawn = learned_strands(load_network(model, "cpu", 1), hair.codec());
        EXPECT_EQ(plain->memory(), 9);  // eight frames of history, and a frame more of answers
        drawn->draw_together(terms, hair.saturation);
        EXPECT_EQ(drawn->memory(), 10);
        Strands before = hair.high.rest, expected = before, shown;
        plain->bind(hair.in.points.data(), before.points.data());
        drawn->bind(hair.in.points.data(), hair.out.points.data());
        for (int f = 0; f < 4; ++f) {
            const HeadWindow heads = hair.take(f);
            plain->run(heads), drawn->run(heads);
            locks.begin(f == 0);
            const int numbers = 3 * codec.particles();
            for (int block = 0; block < codec.lanes().blocks(); ++block) {
                codec.lanes().load(block, numbers, &before.points[0].x, &locks.strands(block)->x);
                locks.take(block, heads.now);
            }
            locks.draw();
            for (int block = 0; block < codec.lanes().blocks(); ++block) {
                locks.show(block, heads.now);
                codec.lanes().store(block, numbers, &locks.strands(block)->x, &expected.points[0].x);
            }
            if (f == 0) shown = hair.out;
            EXPECT_LT(testing::largest_distance(hair.out, expected), 1e-6) << architecture << ' ' << f;
            EXPECT_GT(testing::largest_distance(before, expected), 5e-4) << architecture << ' ' << f;
        }
        // A new run begins without a past.
        const Strands first = shown;
        drawn->restart();
        drawn->run(hair.take(0));
        EXPECT_EQ(testing::largest_distance(hair.out, first), 0);
        EXPECT_THROW(drawn->draw_together(terms, {}), Error);
    }
}

// Displayed strands are led in one round; where Eq 10 follows, as others.
TEST(LearnedStrands, LeadEdgesAsOftenAsTheyAreTold) {
    Scratch scratch;
    Swaying hair;
    std::vector<Strands> shown;
    for (const auto& [target, rounds] : {std::pair{"strands", -1},
                                         {"displayed", most_length_rounds},
                                         {"displayed", -1},
                                         {"strands", 1},
                                         {"strands", 0}}) {
        const std::string model = made_model(scratch.path("m.h5"), "strand_depthwise", inputs, target);
        auto learned = learned_strands(load_network(model, "cpu", 1), hair.codec());
        if (rounds >= 0) learned->lead_edges(rounds);
        learned->bind(hair.in.points.data(), hair.out.points.data());
        learned->run(hair.take(0));
        shown.push_back(hair.out);
        expect_error([&] { learned->lead_edges(most_length_rounds + 1); }, {"5 rounds", "0 to 4"});
        expect_error([&] { learned->lead_edges(-1); }, {"-1 rounds", "0 to 4"});
    }
    EXPECT_EQ(testing::largest_distance(shown[0], shown[1]), 0);
    EXPECT_GT(testing::largest_distance(shown[1], shown[2]), 1e-5);
    EXPECT_EQ(testing::largest_distance(shown[2], shown[3]), 0);
    EXPECT_GT(testing::largest_distance(shown[3], shown[4]), 1e-5);
}

// Of what the network adds, and as it rounds, a walk over the layers: in bytes, or in bfloat16.
TEST(LearnedStrands, InTheFastestBodyDifferByWhatItRounds) {
    Scratch scratch;
    for (const auto& [architecture, most] :
         {std::pair{"strand_mlp", 0.015}, {"strand_depthwise", 0.015}, {"strand_unet_vgg19", 0.03}}) {
        const std::string model = made_model(scratch.path("m.h5"), architecture, inputs);
        Swaying single, fastest;
        auto in_single = learned_strands(load_network(model, "cpu", 1, Body::single_precision),
                                         single.codec(), Body::single_precision);
        auto as_fast = learned_strands(load_network(model, "cpu", 1), fastest.codec());
        in_single->bind(single.in.points.data(), single.out.points.data());
        as_fast->bind(fastest.in.points.data(), fastest.out.points.data());
        for (int f = 0; f < 3; ++f) {
            const HeadWindow heads = single.take(f);
            fastest.take(f);
            in_single->run(heads), as_fast->run(heads);
            const Strands base = in_single->base(heads.now);
            double moved = 0, apart = 0;
            for (size_t k = 0; k < base.points.size(); ++k) {
                moved += norm(single.out.points[k] - base.points[k]);
                apart += norm(fastest.out.points[k] - single.out.points[k]);
            }
            EXPECT_GT(moved / double(base.points.size()), 1e-3) << architecture;
            EXPECT_LT(apart, most * moved) << architecture << " " << f;
        }
    }
}

TEST(RootNetwork, AnswersOfSeveralPatchesAreThoseOfEach) {
    ModelCard card;
    card.codec = "root", card.architecture = "unet_vgg19", card.width = 0.25;
    card.input_channels = card.output_channels = 3, card.upscale = 2;
    torch::manual_seed(4);
    const auto model = make_model(card);
    const torch::NoGradGuard no_grad;
    for (auto& p : model->parameters()) p.add_(0.01 * torch::randn_like(p));
    const auto network = network_of(card, model, "cpu", 1, Body::single_precision);
    const long patches = 3, height = 40, width = 32;
    const Tensor in = torch::rand({patches, 3, height, width});
    Tensor together = torch::empty({patches, 3, 2 * height, 2 * width}), alone = torch::empty_like(together);
    network->run(in.data_ptr<float>(), {patches, 3, height, width}, together.data_ptr<float>());
    for (long k = 0; k < patches; ++k)
        network->run(in[k].data_ptr<float>(), {1, 3, height, width}, alone[k].data_ptr<float>());
    EXPECT_GT((together - up(in)).abs().mean().item<double>(), 1e-4);
    EXPECT_LT((together - alone).abs().max().item<double>(), 1e-5);
}

// As the host gives it within what half precision rounds; in either memory, several patches at once, other
// sizes in turn.
TEST(RootNetwork, OnTheDeviceIsThatOfTheHost) {
#ifdef WETCURL_NETWORKS_ON_DEVICE
    if (!torch::cuda::is_available()) GTEST_SKIP() << "SKIP: no CUDA device";
    // At width 1 kernels of ours convolve where pixels are few.
    for (const auto& [architecture, width] :
         {std::pair{"unet_vgg19", 0.25}, {"unet_vgg19", 1.0}, {"recursive_residual", 0.25}}) {
        ModelCard card;
        card.codec = "root", card.architecture = architecture, card.width = width;
        card.input_channels = card.output_channels = 3, card.upscale = 2;
        torch::manual_seed(4);
        const auto model = make_model(card), other = make_model(card);
        const torch::NoGradGuard no_grad;
        const auto from = model->parameters(), to = other->parameters();
        for (size_t k = 0; k < from.size(); ++k)
            from[k].add_(0.01 * torch::randn_like(from[k])), to[k].copy_(from[k]);
        const auto host = network_of(card, model, "cpu", 1, Body::single_precision),
                   device = network_of(card, other, "cuda", 1);
        for (const std::array<long, 4> shape :
             {std::array<long, 4>{1, 3, 64, 64}, {1, 3, 64, 64}, {1, 3, 64, 64}, {4, 3, 40, 32}}) {
            const Tensor in = torch::rand({shape[0], 3, shape[2], shape[3]}), base = up(in),
                         expected = torch::empty_like(base), found = torch::empty_like(base);
            host->run(in.data_ptr<float>(), shape, expected.data_ptr<float>());
            device->run(in.data_ptr<float>(), shape, found.data_ptr<float>());
            const double size = (expected - base).norm().item<double>();
            ASSERT_GT(size, 0.1) << architecture;
            EXPECT_LT((found - expected).norm().item<double>(), 0.005 * size) << architecture;
            const Tensor there = in.cuda(), answer = torch::empty_like(base, torch::kCUDA);
            torch::cuda::synchronize();
            device->run(there.data_ptr<float>(), shape, answer.data_ptr<float>(), true);
            EXPECT_TRUE(torch::equal(answer.cpu(), found)) << architecture;
        }
    }
#else
    GTEST_SKIP() << "SKIP: built without CUDA, or LibTorch is";
#endif
}

// What is wanted, of the strands at the rows and columns below 3 of the grid.
std::vector<uint8_t> corner_of(const Groom& groom) {
    std::vector<uint8_t> wanted(size_t(groom.rest.count), 0);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column)
            if (const int s = groom.grid.at(column, row); s >= 0) wanted[size_t(s)] = 1;
    return wanted;
}

TEST(CroppedStrands, AreThoseOfTheWholeGridAndTheOthersAreWhereItStartsFrom) {
    Scratch scratch;
    for (const char* architecture : {"strand_mlp", "strand_depthwise", "strand_linear"}) {
        const std::string model = made_model(scratch.path("m.h5"), architecture, inputs);
        Swaying whole, part, none;
        ASSERT_GT(whole.high.grid.width, 5);
        auto learned = learned_strands(load_network(model, "cpu", 1, Body::single_precision), whole.codec(),
                                       Body::single_precision),
             cropped = learned_strands(load_network(model, "cpu", 1, Body::single_precision), part.codec(),
                                       Body::single_precision),
             unasked = learned_strands(load_network(model, "cpu", 1, Body::single_precision), none.codec(),
                                       Body::single_precision);
        const std::vector<uint8_t> wanted = corner_of(part.high);
        cropped->crop(wanted);
        unasked->crop(std::vector<uint8_t>(wanted.size(), 0));
        learned->bind(whole.in.points.data(), whole.out.points.data());
        cropped->bind(part.in.points.data(), part.out.points.data());
        unasked->bind(none.in.points.data(), none.out.points.data());
        for (int f = 0; f < 3; ++f) {
            const HeadWindow heads = whole.take(f);
            learned->run(heads), cropped->run(part.take(f)), unasked->run(none.take(f));
            const Strands base = learned->base(heads.now);
            EXPECT_LT(testing::largest_distance(none.out, base), 1e-6) << architecture;
            double moved = 0;
            for (size_t k = 0; k < base.points.size(); ++k) {
                const bool asked = wanted[k / size_t(base.particles)];
                EXPECT_LT(norm(part.out.points[k] - (asked ? whole.out : base).points[k]), 1e-6)
                    << architecture << ' ' << k;
                moved = std::max(moved, double(norm(whole.out.points[k] - base.points[k])));
            }
            EXPECT_GT(moved, 1e-3) << architecture;
        }
        expect_error([&] { learned->crop({1, 0}); }, {"2 strands"});
    }
    const std::string image = made_model(scratch.path("i.h5"), "strand_recursive_residual", inputs);
    Swaying hair;
    auto learned = learned_strands(load_network(image, "cpu", 1), hair.codec());
    expect_error([&] { learned->crop(corner_of(hair.high)); }, {"strand_recursive_residual", "whole grid"});
}

TEST(LearnedStrands, OnTheDeviceAreThoseOfTheHost) {
#ifdef WETCURL_NETWORKS_ON_DEVICE
    if (!torch::cuda::is_available()) GTEST_SKIP() << "SKIP: no CUDA device";
    Scratch scratch;
    for (const char* architecture : {"strand_mlp", "strand_depthwise", "strand_linear"}) {
        const std::string model = made_model(scratch.path("m.h5"), architecture, inputs);
        Swaying host, device, half;
        auto on_host = learned_strands(load_network(model, "cpu", 1, Body::single_precision), host.codec(),
                                       Body::single_precision);
        auto on_device = device_strands(model, "cuda", device.codec(), device.low, false);
        auto in_half = device_strands(model, "cuda", half.codec(), half.low, true);
        on_host->bind(host.in.points.data(), host.out.points.data());
        on_device->bind(device.in.points.data(), device.out.points.data());
        // What lies on the device is used where it lies.
        DeviceBuffer<Vec3f> low(half.in.points.size()), out(half.out.points.size());
        in_half->bind(low.data(), out.data(), true);
        for (int f = 0; f < 6; ++f) {  // the first warms up, the second is captured
            const HeadWindow heads = host.take(f);
            on_host->run(heads);
            on_device->run(device.take(f));
            half.take(f);
            low.upload(half.in.points.data(), half.in.points.size());
            if (f % 2)
                in_half->run(heads);
            else
                check_cuda(cudaStreamSynchronize(in_half->begin(heads)), "frame");
            EXPECT_THROW(on_device->begin(heads), Error);  // whose memory is the host's
            out.download(half.out.points.data());
            EXPECT_LT(testing::largest_distance(device.out, host.out), 2e-5) << architecture << " " << f;
            const Strands base = on_host->base(heads.now);
            EXPECT_LT(testing::largest_distance(on_device->base(heads.now), base), 1e-5) << architecture;
            double moved = 0, apart = 0;
            for (size_t k = 0; k < base.points.size(); ++k) {
                moved += norm(host.out.points[k] - base.points[k]);
                apart += norm(half.out.points[k] - host.out.points[k]);
            }
            EXPECT_GT(moved / double(base.points.size()), 1e-3) << architecture;
            EXPECT_LT(apart, 0.002 * moved) << architecture << " " << f;  // half precision: within 0.2 %
        }
        // All memory is there by now.
        const auto asked = [] {
            return c10::cuda::CUDACachingAllocator::getDeviceStats(0).allocation[0].allocated;
        };
        const auto before = asked();
        for (int f = 6; f < 12; ++f) in_half->run(half.take(f)), on_device->run(device.take(f));
        EXPECT_EQ(asked(), before) << architecture;
        on_device->restart(), on_host->restart();
        on_host->run(host.take(0)), on_device->run(device.take(0));
        EXPECT_LT(testing::largest_distance(device.out, host.out), 2e-5) << architecture;
        on_host->crop(corner_of(host.high)), on_device->crop(corner_of(host.high));
        for (int f = 1; f < 4; ++f) {
            on_host->run(host.take(f)), on_device->run(device.take(f));
            EXPECT_LT(testing::largest_distance(device.out, host.out), 2e-5) << architecture << " " << f;
        }
    }
#else
    GTEST_SKIP() << "SKIP: built without CUDA, or LibTorch is";
#endif
}

}  // namespace
}  // namespace wetcurl
