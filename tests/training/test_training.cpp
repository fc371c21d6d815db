// Losses, the optimiser, batches, and whole trainings: they overfit, stop, go on to the bit, and say what is
// wrong. One translation unit: LibTorch's headers are slow.
#include <gtest/gtest.h>
#include <torch/cuda.h>

#include <csignal>
#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "base/interrupt.h"
#include "learn/codec/strand_codec.h"
#include "learn/inference/inference.h"
#include "models/adhesion_mlp.h"
#include "models/model_file.h"
#include "models/registry.h"
#include "tests/base/scratch.h"
#include "tests/training/make_pairs.h"
#include "training/checkpoint.h"
#include "training/loop.h"
#include "training/losses.h"
#include "training/optimiser.h"

namespace wetcurl {
namespace {

using testing::expect_error;
using testing::Scratch;

Recipe recipe_of(Codec codec, const std::vector<std::string>& set = {}) {
    TrainRequest request;
    request.set = set;
    std::vector<std::string> names;
    for (const auto& a : architectures())
        if (a.codec == name_of(codec)) names.push_back(a.name);
    return read_recipe(request, codec, names);
}

// ---- losses ----

struct StrandCase {
    static constexpr int particles = 9, strands = 3;
    static constexpr double length = 0.2;
    Batch batch;
    Tensor output;
    StrandCase() {
        torch::manual_seed(1);
        batch.base = 0.15 * torch::randn({strands, strand_coefficients});
        batch.target = 0.1 * torch::randn({strands, strand_coefficients, 1, 1});
        batch.length = torch::tensor({0.15f, 0.2f, 0.25f}).unsqueeze(1),
        batch.relative_length = batch.length / length;
        output = 0.1 * torch::randn({strands, strand_outputs, 1, 1});
    }
    // An answer with those amplitudes.
    static Tensor answer(const Tensor& amplitudes) {
        return torch::cat({amplitudes, torch::zeros({amplitudes.size(0), error_pieces, 1, 1})}, 1);
    }
    static Tensor amplitudes(const Tensor& answer) { return answer.narrow(1, 0, strand_coefficients); }
    double loss(const std::string& only) const {
        std::vector<std::string> set = {"loss.position=0", "loss.edge=0", "loss.doubt=0"};
        set.push_back("loss." + only + "=1");
        return make_loss(Codec::strand, recipe_of(Codec::strand, set), particles, length, torch::kCPU)
            ->of(output, batch)
            .item<double>();
    }
    // Offsets of base + residual, decoded as reconstruction does it.
    std::vector<std::vector<Vec3f>> decoded(const Tensor& residual) const {
        std::vector<std::vector<Vec3f>> out;
        const StrandDct dct(particles);
        const Tensor c = (batch.length * (batch.base + amplitudes(residual).flatten(1))).contiguous();
        for (int s = 0; s < strands; ++s) {
            out.emplace_back(particles);
            dct.decode(c[s].data_ptr<float>(), out.back().data());
        }
        return out;
    }
    // Mean over the strands of a sum over the particles of what `f` makes of (found, wanted, i).
    template <class F>
    double mean(F f, int first, int count) const {
        const auto a = decoded(output), b = decoded(batch.target);
        double sum = 0;
        for (int s = 0; s < strands; ++s)
            for (int i = first; i < first + count; ++i) sum += f(a[size_t(s)], b[size_t(s)], size_t(i));
        return sum / strands;
    }
};

TEST(StrandLoss, IsTheDistanceOfDecodedStrands) {
    const StrandCase c;
    const int n = c.particles;
    const double segment = c.length / (n - 1);
    using V = std::vector<Vec3f>;
    auto edge = [](const V& x, size_t i) { return x[i + 1] - x[i]; };
    auto bend = [&](const V& x, size_t i) { return edge(x, i + 1) - edge(x, i); };
    const double position =
        c.mean([](auto& a, auto& b, size_t i) { return norm(a[i] - b[i]); }, 0, n) / (n * c.length);
    const double edges =
        c.mean([&](auto& a, auto& b, size_t i) { return norm(edge(a, i) - edge(b, i)); }, 0, n - 1) /
        (n - 1) / segment;
    const double curvature =
        c.mean([&](auto& a, auto& b, size_t i) { return norm(bend(a, i) - bend(b, i)); }, 0, n - 2) /
        (n - 2) / segment;
    const double lengths =
        c.mean([&](auto& a, auto& b, size_t i) { return std::abs(norm(edge(a, i)) - norm(edge(b, i))); }, 0,
               n - 1) /
        (n - 1) / segment;
    for (double value : {position, edges, curvature, lengths}) ASSERT_GT(value, 0.01);
    EXPECT_NEAR(c.loss("position"), position, 1e-5 * position);
    EXPECT_NEAR(c.loss("edge"), edges, 1e-5 * edges);
    EXPECT_NEAR(c.loss("curvature"), curvature, 1e-5 * curvature);
    EXPECT_NEAR(c.loss("length"), lengths, 1e-5 * lengths);
    auto loss = make_loss(Codec::strand, recipe_of(Codec::strand), n, c.length, torch::kCPU);
    EXPECT_NEAR(loss->distance(c.output, c.batch).item<double>(), position * c.length, 1e-5 * position);
}

// Six strands: three and the same a frame later.
TEST(StrandLoss, OfSteadinessIsTheErrorOfWhatMovesBetweenTwoFrames) {
    const StrandCase now, later;
    StrandCase both = now;
    both.batch.in_pairs = true;
    torch::manual_seed(2);
    const Tensor offset = 0.1 * torch::randn_like(now.batch.target);
    both.batch.base = torch::cat({now.batch.base, later.batch.base});
    both.batch.target = torch::cat({now.batch.target, now.batch.target + offset});
    both.batch.length = torch::cat({now.batch.length, later.batch.length});
    both.batch.relative_length = torch::cat({now.batch.relative_length, later.batch.relative_length});
    const std::vector<std::string> set = {"loss.position=0", "loss.edge=0", "loss.length=1e-12",
                                          "loss.doubt=0", "loss.steady=1"};
    const auto steady =
        make_loss(Codec::strand, recipe_of(Codec::strand, set), now.particles, now.length, torch::kCPU);
    // An error that stays is steady.
    EXPECT_LT(steady->of(torch::cat({now.output, now.output + StrandCase::answer(offset)}), both.batch)
                  .item<double>(),
              1e-6);
    // One that comes is its mean distance.
    const Tensor found = StrandCase::amplitudes(now.output);
    StrandCase error;
    error.output = StrandCase::answer(found - (now.batch.target + offset));
    error.batch.target = found - now.batch.target;
    error.batch.base.zero_();
    const double expected = error.loss("position");
    ASSERT_GT(expected, 1e-3);
    EXPECT_NEAR(steady->of(torch::cat({now.output, now.output}), both.batch).item<double>(), expected,
                1e-5 * expected);
    // Frames that do not come in pairs have none.
    EXPECT_LT(steady->of(now.output, now.batch).item<double>(), 1e-9);
}

TEST(StrandLoss, HasTheGradientThatDifferencesGive) {
    StrandCase c;
    auto loss = make_loss(Codec::strand,
                          recipe_of(Codec::strand, {"loss.curvature=0.5", "loss.length=0.5", "loss.doubt=0"}),
                          c.particles, c.length, torch::kCPU);
    c.output.requires_grad_();
    loss->of(c.output, c.batch).backward();
    const Tensor direction = c.output.grad().detach().clone();
    const double expected = direction.square().sum().item<double>();
    ASSERT_GT(expected, 1e-3);
    // Single precision: the step balances rounding (1e-7 / step) against curvature (step squared).
    const double step = 1e-4 / std::sqrt(expected);
    torch::NoGradGuard no_grad;
    const double ahead = loss->of(c.output + step * direction, c.batch).item<double>();
    const double behind = loss->of(c.output - step * direction, c.batch).item<double>();
    EXPECT_NEAR((ahead - behind) / (2 * step), expected, 5e-3 * expected);
}

TEST(StrandLoss, HasAFiniteGradientAtTheTarget) {
    StrandCase c;
    auto loss = make_loss(Codec::strand, recipe_of(Codec::strand, {"loss.length=1", "loss.doubt=0"}),
                          c.particles, c.length, torch::kCPU);
    Tensor output = StrandCase::answer(c.batch.target).requires_grad_();
    const Tensor value = loss->of(output, c.batch);
    value.backward();
    EXPECT_LT(value.item<double>(), 1e-6);
    EXPECT_TRUE(torch::isfinite(output.grad()).all().item<bool>());
}

// It is least where each piece's mean error is told.
TEST(StrandLoss, OfDoubtIsLeastWhereErrorsAreTold) {
    StrandCase c;
    const auto loss = make_loss(
        Codec::strand,
        recipe_of(Codec::strand, {"loss.position=0", "loss.edge=0", "loss.length=1e-12", "loss.doubt=1"}),
        c.particles, c.length, torch::kCPU);
    const auto a = c.decoded(c.output), b = c.decoded(c.batch.target);
    Tensor told = c.output.clone();
    for (int s = 0; s < c.strands; ++s)
        for (int piece = 0; piece < error_pieces;
             ++piece) {  // nine particles: each piece has one, but the root
            const float error = norm(a[size_t(s)][size_t(piece) + 1] - b[size_t(s)][size_t(piece) + 1]);
            told[s][answered_errors.first + piece][0][0] =
                std::log(error / (usual_error * c.batch.length[s][0].item<float>()));
        }
    told.requires_grad_();
    loss->of(told, c.batch).backward();
    EXPECT_LT(told.grad().abs().max().item<double>(), 1e-4);
    torch::NoGradGuard no_grad;
    const double least = loss->of(told, c.batch).item<double>();
    for (float off : {-0.5f, 0.5f}) {
        Tensor wrong = told.clone();
        wrong.narrow(1, answered_errors.first, answered_errors.count).add_(off);
        EXPECT_GT(loss->of(wrong, c.batch).item<double>(), least + 0.05);
    }
    // However wrong, as of hair that is new to a network, it is finite and leads back.
    for (float off : {-200.f, 200.f}) {
        Tensor wild = told.detach().clone();
        wild.narrow(1, answered_errors.first, answered_errors.count).add_(off);
        wild.requires_grad_();
        const at::AutoGradMode with_gradients(true);
        const Tensor value = loss->of(wild, c.batch);
        value.backward();
        EXPECT_TRUE(std::isfinite(value.item<double>()));
        const Tensor led = wild.grad().narrow(1, answered_errors.first, answered_errors.count);
        EXPECT_TRUE(torch::isfinite(led).all().item<bool>());
        EXPECT_GT((led * (off > 0 ? 1 : -1)).min().item<double>(), 0);
    }
}

TEST(RootLoss, IsTheMeanOverPixelsThatHoldAStrand) {
    Batch batch;
    batch.target = torch::zeros({1, 3, 2, 2});
    batch.mask = torch::tensor({1.0f, 0.0f, 1.0f, 0.0f}).view({1, 1, 2, 2});
    Tensor output = torch::zeros({1, 3, 2, 2});
    output[0][0][0][0] = 0.3f;  // |.|^2 = 0.09 + 0.16
    output[0][1][0][0] = 0.4f;
    output[0][2][0][1] = 1e6f;  // no strand there
    auto loss = make_loss(Codec::root, recipe_of(Codec::root), 12, 2.0, torch::kCPU);
    EXPECT_NEAR(loss->of(output, batch).item<double>(), 0.5 * 0.25 / 2, 1e-7);
    EXPECT_NEAR(loss->distance(output, batch).item<double>(), 2.0 * 0.5 / 2, 1e-6);
    EXPECT_EQ(loss->count(batch), 2);
}

// ---- the optimiser ----

TEST(Optimiser, TakesTheStepsOfAdamW) {
    torch::manual_seed(2);
    AdhesionMlp model;
    const double decay = 0.1, rate = 0.01;
    Optimiser optimiser(model, decay, 0);
    Tensor w = optimiser.weights.to(torch::kDouble), m = torch::zeros_like(w), v = m.clone();
    for (int t = 1; t <= 3; ++t) {
        const Tensor g = torch::randn_like(w);
        long at = 0;
        for (auto& p : model.parameters()) {
            p.mutable_grad().copy_(g.narrow(0, at, p.numel()).view(p.sizes()));
            at += p.numel();
        }
        optimiser.step(rate);
        m = 0.9 * m + 0.1 * g;
        v = 0.999 * v + 0.001 * g * g;
        w = w * (1 - rate * decay) -
            rate * (m / (1 - std::pow(0.9, t))) / ((v / (1 - std::pow(0.999, t))).sqrt() + 1e-8);
    }
    EXPECT_LT((optimiser.weights - w).abs().max().item<double>(), 1e-6);
    // The model's layers are views of the flat vector.
    EXPECT_EQ(model.parameters()[0].data_ptr<float>(), optimiser.weights.data_ptr<float>());
    EXPECT_EQ(optimiser.steps, 3);
}

TEST(Optimiser, ClipsTheNormAndTellsWhatIsNotFinite) {
    AdhesionMlp model;
    Optimiser optimiser(model, 0, 1);
    auto fill = [&](float value) {
        for (auto& p : model.parameters()) p.mutable_grad().fill_(value);
    };
    fill(5);
    EXPECT_NEAR(optimiser.step(1e-3).item<double>(), 5 * std::sqrt(142.0), 1e-3);
    EXPECT_NEAR(optimiser.first_moment.norm().item<double>(), 0.1, 1e-6);  // (1 - 0.9) of a unit vector
    fill(0);                                                               // which has no direction
    EXPECT_EQ(optimiser.step(1e-3).item<double>(), 0);
    EXPECT_TRUE(torch::isfinite(optimiser.weights).all().item<bool>());
    fill(std::nanf(""));
    EXPECT_TRUE(std::isnan(optimiser.step(1e-3).item<double>()));
}

// ---- batches ----

struct OpenPairs {
    explicit OpenPairs(const std::string& path, const std::vector<std::string>& set = {})
        : OpenPairs({path}, 1, set) {}
    // Those after the first `trained` files are held out.
    OpenPairs(const std::vector<std::string>& paths, size_t trained, const std::vector<std::string>& set = {},
              const Ranks& ranks = {}) {
        std::vector<PairsReader*> pointers;
        for (const auto& path : paths) {
            readers.push_back(std::make_unique<PairsReader>(path));
            pointers.push_back(readers.back().get());
        }
        recipe = recipe_of(readers[0]->codec(), set);
        data = open_data(pointers, trained, recipe, torch::kCPU, ranks);
    }
    const PairsReader& reader() const { return *readers[0]; }
    std::vector<std::unique_ptr<PairsReader>> readers;
    Recipe recipe;
    std::unique_ptr<TrainingData> data;
};

TEST(StrandData, HoldsOutTheLastFramesAndSeesTheOthersOnceAnEpoch) {
    Scratch scratch;
    OpenPairs pairs(testing::make_strand_pairs(scratch.path("p.h5")), {"validation=0.34"});
    pairs.data->begin_epoch(0);
    ASSERT_EQ(pairs.data->steps(), 4);
    ASSERT_EQ(pairs.data->validation_batches(), 2);
    std::vector<float> dynamic(testing::made_dynamic * 36), target(strand_coefficients * 36);
    std::multiset<float> seen;
    for (long s = 0; s < 4; ++s) {
        const Batch b = pairs.data->batch(s);
        EXPECT_EQ(b.input.sizes(),
                  (std::vector<int64_t>{35, testing::made_static + testing::made_dynamic, 1, 1}));
        seen.insert(b.base[0][0].item<float>());
    }
    for (int f = 0; f < 6; ++f) {
        pairs.reader().frame(0, f, dynamic.data(), target.data());
        if (f < 4) {
            EXPECT_EQ(seen.count(dynamic[1]), 1u) << f;  // pixel 0 holds no strand
        } else {
            const Batch b = pairs.data->validation_batch(f - 4);
            EXPECT_EQ(b.base[0][0].item<float>(), dynamic[1]);
            EXPECT_EQ(b.target[34][strand_coefficients - 1][0][0].item<float>(), target.back());
            EXPECT_EQ(b.input[34][testing::made_static + 3][0][0].item<float>(), dynamic[4 * 36 - 1]);
        }
    }
}

// A scene of long hair and one of short, by lengths the same: both teach as much, however far apart their
// metres.
TEST(StrandData, ScenesOfLongAndOfShortHairCountAlike) {
    Scratch scratch;
    const auto of_length = [&](const std::string& name, float length) {
        return testing::make_strand_pairs(scratch.path(name), 6, 1, 0.02f, 11, false, {}, length);
    };
    OpenPairs pairs({of_length("short.h5", 0.1f), of_length("long.h5", 0.8f)}, 2, {"validation=0"});
    const auto loss =
        make_loss(Codec::strand, pairs.recipe, testing::made_particles, pairs.data->unit(), torch::kCPU);
    pairs.data->begin_epoch(0);
    ASSERT_EQ(pairs.data->steps(), 2);
    std::vector<double> losses, distances;
    for (long step = 0; step < 2; ++step) {
        const Batch batch = pairs.data->batch(step);
        const Tensor none = loss->base_output(batch);
        losses.push_back(loss->of(none, batch).item<double>());
        distances.push_back(loss->distance(none, batch).item<double>());
    }
    ASSERT_GT(losses[0], 1e-3);
    EXPECT_NEAR(losses[0], losses[1], 1e-5 * losses[0]);
    const double ratio = distances[0] / distances[1];
    EXPECT_NEAR(std::max(ratio, 1 / ratio), 8, 1e-3);
}

TEST(StrandData, NormalisesByTheFramesThatTrainingSees) {
    Scratch scratch;
    OpenPairs pairs(testing::make_strand_pairs(scratch.path("p.h5")));
    ModelCard card;
    pairs.data->describe(card);
    const auto& mean = card.arrays.at("input_mean");
    const auto& deviation = card.arrays.at("input_std");
    ASSERT_EQ(mean.size(), size_t(card.input_channels));
    std::vector<Tensor> all;
    pairs.data->begin_epoch(0);
    for (long s = 0; s < pairs.data->steps(); ++s) all.push_back(pairs.data->batch(s).input.flatten(1));
    const Tensor x = (torch::cat(all) - torch::tensor(mean)) / torch::tensor(deviation);
    EXPECT_LT(x.mean(0).abs().max().item<double>(), 1e-5);
    EXPECT_EQ(mean[0], 9.81f);
    EXPECT_EQ(x.select(1, 0).abs().max().item<double>(), 0);  // the constant channel
    EXPECT_LT((x.narrow(1, 1, x.size(1) - 1).square().mean(0) - 1).abs().max().item<double>(), 1e-4);
    // Strands of one length are as long as their scene's are.
    EXPECT_LT((pairs.data->batch(0).relative_length - 1).abs().max().item<double>(), 1e-6);
    const auto &low = card.arrays.at("input_low"), &high = card.arrays.at("input_high");
    EXPECT_TRUE(torch::equal(torch::cat(all).amin(0), torch::tensor(low)));
    EXPECT_TRUE(torch::equal(torch::cat(all).amax(0), torch::tensor(high)));
}

TEST(StrandData, TakesTheStrandsAfterCohesionWhereAskedTo) {
    Scratch scratch;
    const std::string file = testing::make_strand_pairs(scratch.path("p.h5"), 6, 6, 0.02f, 11, true);
    OpenPairs before(file), after(file, {"target=displayed"});
    const Tensor a = before.data->validation_batch(0).target, b = after.data->validation_batch(0).target;
    ASSERT_GT(a.abs().max().item<double>(), 1e-3);
    EXPECT_TRUE(torch::equal(0.5 * a, b));
    ModelCard card;
    after.data->describe(card);
    EXPECT_EQ(card.target, "displayed");
    expect_error([&] { OpenPairs(testing::make_strand_pairs(scratch.path("q.h5")), {"target=displayed"}); },
                 {"q.h5", "after cohesion"});
}

TEST(StrandData, LaysWholeFramesOutForANetworkThatSeesNeighbours) {
    Scratch scratch;
    const std::string file = testing::make_strand_pairs(scratch.path("p.h5"));
    OpenPairs rows(file), frames(file, {"architecture=strand_depthwise", "batch=2"});
    frames.data->begin_epoch(0);
    const Batch two = frames.data->batch(0);
    EXPECT_EQ(two.input.sizes(),
              (std::vector<int64_t>{2, testing::made_static + testing::made_dynamic, 6, 6}));
    EXPECT_EQ(two.input.select(2, 0).select(2, 0).abs().max().item<double>(), 0);  // pixel 0: no strand
    const Batch flat = rows.data->validation_batch(0), whole = frames.data->validation_batch(0);
    EXPECT_TRUE(torch::equal(to_rows(whole.input).index_select(0, whole.pixels), flat.input.flatten(1)));
    EXPECT_TRUE(torch::equal(whole.target, flat.target));
    // The loss takes the pixels that hold a strand: an answer that is absurd in the others changes nothing.
    const auto loss = make_loss(Codec::strand, frames.recipe, testing::made_particles, 0.2, torch::kCPU);
    Tensor answer = torch::zeros({1, strand_outputs, 6, 6});
    const double zero = loss->of(answer, whole).item<double>();
    ASSERT_GT(zero, 1e-3);
    EXPECT_NEAR(zero, loss->of(StrandCase::answer(torch::zeros_like(flat.target)), flat).item<double>(),
                1e-6 * zero);
    answer.select(2, 0).select(2, 0).fill_(1e3);
    EXPECT_EQ(loss->of(answer, whole).item<double>(), zero);
}

TEST(StrandData, GivesFramesInPairsWhereSteadinessIsLearned) {
    Scratch scratch;
    const std::string file =
        testing::make_strand_pairs(scratch.path("p.h5"), 6, 7, 0.02f, 11, false, {0, 1, 2, 3, 4, 5, 6});
    OpenPairs single(file, {"validation=0"}), pairs(file, {"validation=0", "loss.steady=1", "batch=4"});
    EXPECT_EQ(pairs.data->steps(), 2);  // three pairs of seven frames, two a step
    std::vector<Batch> frames;
    single.data->begin_epoch(0);
    for (long k = 0; k < single.data->steps(); ++k) frames.push_back(single.data->batch(k));
    auto follows = [&](const Tensor& a, const Tensor& b) {  // frames 0, 1, ... of the file
        const PairsReader reader(file);
        const size_t size = size_t(testing::made_dynamic) * 36;
        std::vector<float> input(size), target(size_t(strand_coefficients) * 36);
        long at[2] = {-1, -1};
        for (int f = 0; f < 7; ++f) {
            reader.frame(0, f, input.data(), target.data());
            const Tensor first = torch::from_blob(target.data(), {strand_coefficients, 36}).narrow(1, 1, 35);
            if (torch::equal(first.t(), a.flatten(1))) at[0] = f;
            if (torch::equal(first.t(), b.flatten(1))) at[1] = f;
        }
        return at[0] >= 0 && at[0] % 2 == 0 && at[1] == at[0] + 1;
    };
    pairs.data->begin_epoch(0);
    for (long k = 0; k < 2; ++k) {
        const Batch batch = pairs.data->batch(k);
        ASSERT_TRUE(batch.in_pairs);
        const long count = batch.target.size(0) / 2;
        ASSERT_EQ(count, k == 0 ? 70 : 35);
        for (long from = 0; from < count; from += 35)
            EXPECT_TRUE(follows(batch.target.narrow(0, from, 35), batch.target.narrow(0, count + from, 35)));
    }
    EXPECT_FALSE(single.data->batch(0).in_pairs);
    expect_error(
        [&] {
            OpenPairs apart(
                testing::make_strand_pairs(scratch.path("apart.h5"), 6, 4, 0.02f, 11, false, {0, 2, 4, 6}),
                {"loss.steady=1", "batch=2"});
        },
        {"loss.steady", "in a row"});
}

TEST(StrandData, InputsThatAreLeftOutAreMute) {
    Scratch scratch;
    // Channels of the codec itself; every one of them varies.
    StrandPairs run;
    run.static_channels = static_channels, run.dynamic_channels = dynamic_channels;
    run.height = run.width = 4, run.frames = 3;
    std::mt19937 random(2);
    run.fixed = testing::uniform(random, static_channels * run.pixels());
    run.mask.assign(run.pixels(), 1), run.length.assign(run.pixels(), 0.2f);
    PairsWriter file(scratch.path("p.h5"), Codec::strand, 24, true);
    file.begin(run);
    for (int f = 0; f < 3; ++f)
        file.append(testing::uniform(random, dynamic_channels * run.pixels()).data(),
                    testing::uniform(random, strand_coefficients * run.pixels()).data());
    file.commit();
    OpenPairs pairs(scratch.path("p.h5"), {"leave_out=saturation history"});
    ModelCard card;
    pairs.data->describe(card);
    for (const InputGroup& g : strand_inputs) {
        const bool left_out = std::string(g.name) == "saturation" || std::string(g.name) == "history";
        for (int c = g.channels.first; c < g.channels.end(); ++c)
            for (const bool mute : {card.arrays["input_std"].at(size_t(c)) > 1e20f,
                                    card.arrays["input_low"].at(size_t(c)) < -1e20f,
                                    card.arrays["input_high"].at(size_t(c)) > 1e20f})
                EXPECT_EQ(mute, left_out) << g.name << " " << c;
    }
    expect_error([&] { OpenPairs(scratch.path("p.h5"), {"leave_out=histroy"}); },
                 {"leave_out", "histroy", "history"});
}

// Four files, the last two of which are held out.
struct HeldOut {
    Scratch scratch;
    std::vector<std::string> strands, roots;
    HeldOut() {
        for (int k = 0; k < 4; ++k) {
            const std::string name = std::to_string(k) + ".h5";
            strands.push_back(
                testing::make_strand_pairs(scratch.path("s" + name), 6, 2 + k, 0.02f, unsigned(20 + k)));
            roots.push_back(testing::make_root_pairs(scratch.path("r" + name), 2 + k, 10 * k));
        }
    }
};

TEST(EveryData, FilesOfTheirOwnAreHeldOutWholeAndTheOthersSeenWhole) {
    const HeldOut files;
    for (const auto& paths : {files.strands, files.roots}) {
        // Patches of the whole image, so that every batch of one is a frame. The recipe's share does not
        // count here: there are files to hold out.
        std::vector<std::string> set = {"validation=0.5", "batch=1"};
        if (paths == files.roots) set.push_back("patch=32");
        OpenPairs pairs(paths, 2, set);
        pairs.data->begin_epoch(0);
        ASSERT_EQ(pairs.data->steps(), 2 + 3);
        ASSERT_EQ(pairs.data->validation_batches(), 4 + 5);
        std::multiset<float> trained;
        for (long s = 0; s < pairs.data->steps(); ++s) {
            const Batch b = pairs.data->batch(s);
            trained.insert(b.base.flatten()[0].item<float>());
        }
        std::multiset<float> expected;
        long held = 0;
        for (size_t k = 0; k < paths.size(); ++k)
            for (int f = 0; f < int(k) + 2; ++f) {
                // Of the first pixel that holds a strand, or the first colour.
                const bool strand = pairs.reader().codec() == Codec::strand;
                std::vector<float> inputs(size_t(strand ? testing::made_dynamic * 36 : 3 * 32 * 32)),
                    target(size_t(strand ? strand_coefficients * 36 : 3 * 64 * 64));
                pairs.readers[k]->frame(0, f, inputs.data(), target.data());
                const float first = inputs[strand ? 1 : 0];
                if (k < 2) {
                    expected.insert(first);
                } else {
                    const Batch b = pairs.data->validation_batch(held++);  // in the order of the files
                    EXPECT_EQ(b.base.flatten()[0].item<float>(), first) << paths[k] << ", frame " << f;
                    EXPECT_EQ(b.target.flatten()[-1].item<float>(), target.back());
                }
            }
        EXPECT_EQ(trained, expected) << paths[0];
        EXPECT_EQ(std::set<float>(expected.begin(), expected.end()).size(), 5u);  // frames that differ
    }
}

TEST(EveryData, HeldOutFilesTeachNothing) {
    const HeldOut files;
    OpenPairs alone({files.strands[0], files.strands[1]}, 2, {"validation=0"}), beside(files.strands, 2);
    EXPECT_EQ(alone.data->validation_batches(), 0);
    ModelCard a, b;
    alone.data->describe(a), beside.data->describe(b);
    EXPECT_EQ(a.arrays, b.arrays);
    alone.data->begin_epoch(3), beside.data->begin_epoch(3);
    ASSERT_EQ(alone.data->steps(), beside.data->steps());
    for (long s = 0; s < alone.data->steps(); ++s)
        EXPECT_TRUE(torch::equal(alone.data->batch(s).input, beside.data->batch(s).input)) << s;
}

TEST(EveryData, DrawsBySeedAndEpochAlone) {
    Scratch scratch;
    const std::vector<std::string> files = {testing::make_strand_pairs(scratch.path("s.h5")),
                                            testing::make_root_pairs(scratch.path("r.h5")),
                                            testing::make_adhesion_pairs(scratch.path("a.h5"))};
    for (const auto& file : files) {
        const std::vector<std::string> patch =
            file == files[1] ? std::vector<std::string>{"patch=8"} : std::vector<std::string>{};
        OpenPairs one(file, patch), other(file, patch);
        auto inputs = [](OpenPairs& p, long epoch) {
            p.data->begin_epoch(epoch);
            std::vector<Tensor> all;
            for (long s = 0; s < p.data->steps(); ++s) all.push_back(p.data->batch(s).input);
            return torch::cat(all);
        };
        inputs(one, 3);
        const Tensor a = inputs(one, 7);
        EXPECT_TRUE(torch::equal(a, inputs(other, 7))) << file;
        EXPECT_FALSE(torch::equal(a, inputs(other, 8))) << file;
        auto seeded = patch;
        seeded.push_back("seed=1");
        OpenPairs third(file, seeded);
        EXPECT_FALSE(torch::equal(a, inputs(third, 7))) << file;
    }
}

TEST(EveryData, ProcessesSeeTogetherTheBatchesOfOne) {
    Scratch scratch;
    const std::vector<std::pair<std::string, std::string>> cases = {
        {testing::make_strand_pairs(scratch.path("s.h5")), "batch=2"},
        {testing::make_root_pairs(scratch.path("r.h5")), "batch=3"},
        {testing::make_adhesion_pairs(scratch.path("a.h5")), "batch=4799"}};
    for (const auto& [file, batch] : cases) {
        const OpenPairs whole(file, {batch});
        std::vector<std::unique_ptr<OpenPairs>> parts;
        for (long r = 0; r < 3; ++r) {
            Ranks ranks;
            ranks.mine = r, ranks.of = 3;
            parts.push_back(std::make_unique<OpenPairs>(std::vector{file}, 1, std::vector{batch}, ranks));
        }
        long empty = 0;
        whole.data->begin_epoch(1);
        for (const auto& part : parts) part->data->begin_epoch(1);
        for (long s = 0; s < whole.data->steps(); ++s) {
            std::vector<Tensor> found;
            for (const auto& part : parts) {
                const Batch share = part->data->batch(s);
                if (!share.empty()) found.push_back(share.target.flatten(1));
                empty += share.empty();
            }
            auto sorted = [](const Tensor& rows) { return std::get<0>(rows.flatten().sort()); };
            EXPECT_TRUE(torch::equal(sorted(torch::cat(found)), sorted(whole.data->batch(s).target))) << file;
        }
        EXPECT_EQ(whole.data->steps(), parts[1]->data->steps());
        EXPECT_GT(empty, 0) << file;  // the last batch is too small for three
    }
}

TEST(RootData, CutsInputTargetAndMaskAtTheSamePlace) {
    Scratch scratch;
    OpenPairs pairs(testing::make_root_pairs(scratch.path("p.h5")), {"patch=8", "batch=5"});
    pairs.data->begin_epoch(0);
    EXPECT_EQ(pairs.data->steps(), ceil(4 * 16 / 5.0));  // 4 frames of 16 patches
    const Batch b = pairs.data->batch(0);
    EXPECT_EQ(b.input.sizes(), (std::vector<int64_t>{5, 3, 8, 8}));
    EXPECT_EQ(b.target.sizes(), (std::vector<int64_t>{5, 3, 16, 16}));
    const auto even = torch::indexing::Slice(torch::indexing::None, torch::indexing::None, 2);
    EXPECT_TRUE(torch::equal(b.base.index({"...", even, even}), b.input));
    // Where a strand is, the target is dry - dry^2 / 10; elsewhere 50.
    const Tensor dry = b.base, wet = dry - 0.1 * dry * dry;
    EXPECT_GT(b.mask.sum().item<float>(), 0);
    EXPECT_LT(((b.target - wet).abs() * b.mask).max().item<double>(), 2e-3);  // up() of a sine
    EXPECT_TRUE(((b.target == 50).to(torch::kFloat) + b.mask == 1).all().item<bool>());
    EXPECT_NEAR(pairs.data->unit(), 1.3, 1e-6);
}

TEST(AdhesionData, DrawsContactAndFreeInEqualNumbersAndValidatesOnTheNaturalOnes) {
    Scratch scratch;
    OpenPairs pairs(testing::make_adhesion_pairs(scratch.path("p.h5")), {"epoch_samples=1000", "batch=500"});
    pairs.data->begin_epoch(0);
    ASSERT_EQ(pairs.data->steps(), 2);
    for (long s = 0; s < 2; ++s) EXPECT_EQ(pairs.data->batch(s).input.select(1, 4).sum().item<double>(), 250);
    ASSERT_EQ(pairs.data->validation_batches(), 1);
    const Batch held = pairs.data->validation_batch(0);
    EXPECT_EQ(held.input.size(0), 600);
    EXPECT_EQ(held.input.select(1, 4).sum().item<double>(), 60);
    EXPECT_TRUE(torch::equal(held.base.flatten(), held.input.select(1, 7).flatten()));
}

// ---- whole trainings ----

struct Job {
    Scratch scratch;
    TrainRequest request;
    std::string said;
    Job(Codec codec, const std::vector<std::string>& set) {
        const std::string pairs = scratch.path("pairs.h5");
        if (codec == Codec::strand) testing::make_strand_pairs(pairs);
        if (codec == Codec::root) testing::make_root_pairs(pairs);
        if (codec == Codec::adhesion) testing::make_adhesion_pairs(pairs);
        request.kind = codec == Codec::adhesion ? "adhesion" : "sr";
        request.pairs = {pairs};
        request.output = scratch.path("model.h5");
        request.set = set;
        request.threads = 1;  // small tensors: a second one would only wait
        request.log = [this](const std::string& text) { said += text + "\n"; };
    }
    bool has(const std::string& ending) const { return std::filesystem::exists(request.output + ending); }
    std::vector<nlohmann::json> lines() const {
        std::vector<nlohmann::json> out;
        std::ifstream file(request.output + ".jsonl");
        for (std::string line; std::getline(file, line);) {
            out.push_back(nlohmann::json::parse(line));
            out.back().erase("seconds");
        }
        return out;
    }
    double fall() const {
        return lines().front()["loss"].get<double>() / lines().back()["loss"].get<double>();
    }
};

// Of this machine.
std::vector<std::string> devices() {
    std::vector<std::string> out{"cpu"};
    if (torch::cuda::is_available()) out.push_back("cuda");
    return out;
}

TEST(Training, OverfitsOneFrameOfStrandsFiftyfold) {
    for (const auto& device : devices())
        for (const char* architecture : {"strand_mlp", "strand_depthwise"}) {
            Job job(Codec::strand, {"epochs=600", "width=0.125", "validation=0.8", "weight_decay=0",
                                    "validate_every=600", "loss.doubt=0"});
            job.request.architecture = architecture;
            job.request.device = device;
            train(job.request);
            EXPECT_GT(job.fall(), 50) << architecture << " on " << device;
        }
}

TEST(Training, RateFallsAsHalfACosineOrStays) {
    for (const std::string schedule : {"cosine", "constant"}) {
        Job job(Codec::strand, {"epochs=4", "width=0.125", "learning_rate=2e-3", "schedule=" + schedule});
        job.request.architecture = "strand_mlp";
        train(job.request);
        const auto lines = job.lines();
        ASSERT_EQ(lines.size(), 4u);
        // After a quarter, a half, three quarters and all of the steps.
        const double left[] = {(2 + std::sqrt(2.0)) / 4, 0.5, (2 - std::sqrt(2.0)) / 4, 0};
        for (size_t e = 0; e < 4; ++e)
            EXPECT_NEAR(lines[e]["learning_rate"].get<double>(), 2e-3 * (schedule == "cosine" ? left[e] : 1),
                        1e-12)
                << schedule << ", epoch " << e + 1;
    }
}

TEST(Training, OverfitsOneBatchOfPatchesWithEveryRootNetwork) {
    for (const auto& device : devices())
        for (const char* architecture : {"unet_vgg19", "recursive_residual"}) {
            Job job(Codec::root, {"epochs=250", "width=0.125", "learning_rate=5e-4", "schedule=cosine",
                                  "validation=0.8", "validate_every=250"});
            job.request.architecture = architecture;
            job.request.device = device;
            train(job.request);
            EXPECT_GT(job.fall(), 50) << architecture << " on " << device;
        }
}

TEST(Training, TeachesTheAdhesionNetworkItsFunction) {
    for (const auto& device : devices()) {
        Job job(Codec::adhesion,
                {"epochs=1000", "learning_rate=1e-2", "epoch_samples=512", "validate_every=1000"});
        job.request.device = device;
        train(job.request);
        EXPECT_GT(job.fall(), 50) << device;
        // On samples not seen, against the force of the step before.
        const auto last = job.lines().back();
        EXPECT_LT(last["validation_loss"].get<double>(), 0.02 * last["base_loss"].get<double>()) << device;
        const auto numbers = load_model(job.request.output).first.numbers;
        EXPECT_LT(numbers.at("validation_nrmse"), 0.15 * numbers.at("base_nrmse")) << device;
        const auto samples = PairsReader(job.request.pairs[0]).adhesion(0);
        double squares = 0, touching = 0;
        for (size_t s = samples.size() * 4 / 5; s < samples.size(); ++s)
            if (samples[s].contact)
                squares += std::pow(samples[s].input[7] - samples[s].target, 2), ++touching;
        EXPECT_NEAR(numbers.at("base_nrmse_in_contact"), std::sqrt(squares / touching), 1e-6);
        EXPECT_LT(numbers.at("validation_nrmse_in_contact"), 0.15 * numbers.at("base_nrmse_in_contact"));
        EXPECT_NE(job.said.find("nRMSE"), std::string::npos);
    }
}

// Ctrl-C at the first look after `steps` steps.
void interrupt_after(TrainRequest& request, long steps) {
    request.progress = [steps](long done, long, const std::string&) {
        if (done >= steps) std::raise(SIGINT);
    };
}

TEST(Training, StoppedAndResumedGivesTheBitsOfOneGo) {
    for (Codec codec : {Codec::strand, Codec::root, Codec::adhesion}) {
        std::vector<std::string> set = {"epochs=5", "validate_every=1"};
        if (codec == Codec::root)
            set.insert(set.end(), {"width=0.125", "patch=16", "batch=4", "architecture=recursive_residual"});
        if (codec == Codec::strand) set.push_back("width=0.1");
        if (codec == Codec::adhesion) set.insert(set.end(), {"batch=1024", "epoch_samples=4096"});
        Job whole(codec, set), parts(codec, set);
        train(whole.request);
        parts.request.looks_apart = 3;
        interrupt_after(parts.request, 10);
        EXPECT_THROW(train(parts.request), Interrupted) << name_of(codec);
        EXPECT_TRUE(parts.has(".checkpoint"));
        EXPECT_FALSE(parts.has(""));
        EXPECT_FALSE(parts.has(".checkpoint.partial"));
        const auto cut = parts.lines();
        EXPECT_LT(cut.size(), 5u);
        // What a crash after the checkpoint might have left in the log is dropped.
        std::ofstream(parts.request.output + ".jsonl", std::ios::app) << "{\"epoch\":99}\n";
        parts.request.progress = nullptr;
        parts.request.resume = true;
        train(parts.request);
        EXPECT_FALSE(parts.has(".checkpoint"));
        auto a = load_model(whole.request.output), b = load_model(parts.request.output);
        for (const auto& p : a.second->named_parameters())
            EXPECT_TRUE(torch::equal(p.value(), b.second->named_parameters()[p.key()]))
                << name_of(codec) << " " << p.key();
        EXPECT_EQ(a.first.numbers, b.first.numbers);
        EXPECT_EQ(whole.lines(), parts.lines()) << name_of(codec);
        ASSERT_EQ(whole.lines().size(), 5u);
        EXPECT_LT(whole.lines().back()["loss"], whole.lines().front()["loss"]);
    }
}

TEST(Training, ASecondOneOfTheSameModelIsRefusedAndTheFirstEndsAsIfAlone) {
    const std::vector<std::string> set = {"epochs=3", "width=0.1", "checkpoint_seconds=0"};
    Job alone(Codec::strand, set), first(Codec::strand, set);
    train(alone.request);
    long refused = 0;
    TrainRequest second = first.request;
    first.request.progress = [&](long done, long, const std::string&) {
        if (done != 8) return;
        for (const bool resume : {false, true}) {
            second.overwrite = !resume, second.resume = resume;
            expect_error([&] { train(second); }, {second.output, "writes it", "wait until it ends"});
            ++refused;
        }
    };
    train(first.request);
    EXPECT_EQ(refused, 2);
    EXPECT_EQ(alone.lines(), first.lines());
    auto a = load_model(alone.request.output), b = load_model(first.request.output);
    for (const auto& p : a.second->named_parameters())
        EXPECT_TRUE(torch::equal(p.value(), b.second->named_parameters()[p.key()])) << p.key();
    for (const char* left : {".partial", ".checkpoint", ".checkpoint.partial"}) EXPECT_FALSE(first.has(left));
}

TEST(Training, KeepsTheBestOnHeldOutFrames) {
    // So large a rate that the loss goes up and down.
    Job job(Codec::strand, {"epochs=12", "width=0.1", "learning_rate=1", "schedule=constant"});
    train(job.request);
    double best = 1e300;
    long at = 0;
    for (const auto& line : job.lines())
        if (line["validation_loss"] < best) best = line["validation_loss"], at = line["epoch"];
    EXPECT_LT(at, 12);
    const ModelCard card = read_card(job.request.output);
    EXPECT_EQ(card.numbers.at("best_epoch"), at);
    EXPECT_EQ(card.numbers.at("best_loss"), best);
    EXPECT_NE(card.recipe.find("learning_rate = 1"), std::string::npos);
    EXPECT_NE(card.inputs.find("pairs.h5 "), std::string::npos);
}

TEST(Training, IsValidatedOnFilesOfTheirOwn) {
    Job job(Codec::strand, {"epochs=40", "width=0.125", "validate_every=20"});
    const std::string held = testing::make_strand_pairs(job.scratch.path("held.h5"), 6, 3, 0.02f, 12);
    job.request.validation = {held};
    long steps = 0;
    job.request.progress = [&](long, long total, const std::string&) { steps = total; };
    train(job.request);
    EXPECT_EQ(steps, 40 * 6);  // no frame of the file itself is held out
    const auto last = job.lines().back();
    // The same smooth law on strands never seen.
    EXPECT_LT(last["validation_loss"].get<double>(), 0.9 * last["base_loss"].get<double>());
    const ModelCard card = read_card(job.request.output);
    EXPECT_NE(card.inputs.find("pairs.h5 "), std::string::npos);
    EXPECT_NE(card.inputs.find("held.h5 "), std::string::npos);
    // The base's loss is that of the held-out file alone.
    OpenPairs alone(held, {"validation=0"});
    auto loss =
        make_loss(Codec::strand, alone.recipe, testing::made_particles, alone.data->unit(), torch::kCPU);
    alone.data->begin_epoch(0);
    double sum = 0;
    for (long s = 0; s < alone.data->steps(); ++s) {
        const Batch b = alone.data->batch(s);
        sum += loss->of(loss->base_output(b), b).item<double>();
    }
    const double base = last["base_loss"];
    EXPECT_NEAR(sum / double(alone.data->steps()), base, 1e-5 * base);  // single precision
}

TEST(Training, ModelOfARunAnswersThroughTheInferenceInterface) {
    Job job(Codec::root, {"epochs=2", "width=0.125", "patch=16"});
    train(job.request);
    for (const auto& device : devices()) {
        auto network = load_network(job.request.output, device, 1,
                                    device == "cpu" ? Body::single_precision : Body::fastest);
        EXPECT_EQ(network->card().arrays.at("b_max"), (std::vector<float>{0.3f, 0.4f, 1.2f}));
        torch::manual_seed(1);
        const Tensor x = torch::rand({2, 3, 20, 24});
        Tensor y = torch::full({2, 3, 40, 48}, -1.0f);
        network->run(x.data_ptr<float>(), {2, 3, 20, 24}, y.data_ptr<float>());
        torch::NoGradGuard no_grad;
        const Tensor expected = load_model(job.request.output).second->forward(x);
        const double moved = (y - up(x)).abs().max().item<double>();
        EXPECT_GT(moved, 1e-5);
        EXPECT_LT(moved, 0.5);
        if (device == "cpu") {
            EXPECT_TRUE(torch::equal(y, expected));
        }
        // The other device's body is in half precision.
        const double allowed = device == "cpu" ? 1e-3 : 1e-2;
        EXPECT_LT((y - expected).abs().max().item<double>(), allowed * moved) << device;
    }
}

TEST(Training, InBfloat16LearnsTheSameThing) {
    Job job(Codec::strand, {"epochs=30", "width=0.25", "precision=bfloat16"}),
        other(Codec::strand, {"epochs=30", "width=0.25"});
    train(job.request);
    train(other.request);
    const double half = job.lines().back()["loss"], full = other.lines().back()["loss"];
    EXPECT_GT(job.fall(), 2);
    EXPECT_NE(half, full);
    EXPECT_NEAR(half, full, 0.3 * full);
}

TEST(Training, BegunFromAModelGoesOnFromItsWeightsAndScales) {
    Job first(Codec::strand, {"epochs=40", "width=0.25"}),
        on(Codec::strand, {"epochs=1", "width=0.25", "learning_rate=1e-9"});
    train(first.request);
    // Other pairs, whose means and deviations differ.
    testing::make_strand_pairs(on.request.pairs[0], 6, 8, 0.02f);
    on.request.from = first.request.output;
    train(on.request);
    const auto [before, taught] = load_model(first.request.output);
    const auto [after, same] = load_model(on.request.output);
    for (const char* name : {"input_mean", "input_std", "output_scale"})
        EXPECT_EQ(before.arrays.at(name), after.arrays.at(name)) << name;
    // It has learned from both.
    ModelCard own;
    OpenPairs(on.request.pairs[0]).data->describe(own);
    int widened = 0;
    for (size_t c = 0; c < size_t(after.input_channels); ++c) {
        const auto of = [&](const ModelCard& card, const char* name) { return card.arrays.at(name).at(c); };
        EXPECT_EQ(of(after, "input_low"), std::min(of(before, "input_low"), of(own, "input_low")));
        EXPECT_EQ(of(after, "input_high"), std::max(of(before, "input_high"), of(own, "input_high")));
        widened += of(after, "input_high") > of(before, "input_high");
    }
    EXPECT_GT(widened, 0);
    const torch::NoGradGuard no_grad;
    const Tensor x = torch::randn({2, before.input_channels, 4, 4});
    EXPECT_LT((taught->forward(x) - same->forward(x)).abs().max().item<double>(), 1e-5);
    EXPECT_NE(after.inputs.find("model.h5"), std::string::npos) << after.inputs;
}

TEST(Training, KeepsWhatItBeganWithWhereNothingIsBetter) {
    Job first(Codec::strand, {"epochs=40", "width=0.25"}),
        on(Codec::strand, {"epochs=2", "width=0.25", "learning_rate=0.03", "schedule=constant"});
    train(first.request);
    on.request.from = first.request.output;
    train(on.request);
    const auto [before, taught] = load_model(first.request.output);
    const auto [after, same] = load_model(on.request.output);
    EXPECT_EQ(after.numbers.at("best_epoch"), 0);
    EXPECT_NEAR(after.numbers.at("begun_with_mm"), before.numbers.at("validation_mm"), 1e-6);
    EXPECT_NEAR(after.numbers.at("validation_mm"), before.numbers.at("validation_mm"), 1e-6);
    for (const auto& p : taught->named_parameters())
        EXPECT_TRUE(torch::equal(p.value(), same->named_parameters()[p.key()])) << p.key();
    const auto lines = on.lines();
    ASSERT_EQ(lines.size(), 3u);
    EXPECT_EQ(lines[0]["epoch"], 0);
    EXPECT_FALSE(lines[0].count("loss"));
    EXPECT_NEAR(lines[0]["validation_mm"], before.numbers.at("validation_mm"), 1e-6);
}

// ---- what can go wrong ----

TEST(TrainingErrors, AModelToBeginWithMustFit) {
    Job wide(Codec::strand, {"epochs=1", "width=0.25"}), job(Codec::strand, {"epochs=1", "width=0.1"});
    train(wide.request);
    job.request.from = wide.request.output;
    expect_error<Misuse>([&] { train(job.request); }, {"--from", "width 0.25", "allowed here is 0.1"});
    job.request.architecture = "strand_depthwise";
    expect_error<Misuse>([&] { train(job.request); },
                         {"--from", "architecture strand_mlp", "strand_depthwise"});
    job.request.from = job.request.pairs[0];
    expect_error([&] { train(job.request); }, {"pairs.h5", "wetcurl model"});
    Job blind(Codec::strand, {"epochs=1", "width=0.25"});
    blind.request.from = wide.request.output;
    blind.request.set.push_back("leave_out=history");
    expect_error<Misuse>([&] { train(blind.request); }, {"leave_out", "--from"});
    job.request.from = job.scratch.path("absent.h5");
    expect_error([&] { train(job.request); }, {"absent.h5"});
    EXPECT_FALSE(job.has(""));
}

TEST(TrainingErrors, DivergenceNamesTheStep) {
    Job job(Codec::strand, {"epochs=2", "width=0.1"});
    testing::make_strand_pairs(job.request.pairs[0], 6, 6, 1e25f);  // its square is beyond single precision
    for (const int looks_apart : {1, 3, 32}) {
        job.request.looks_apart = looks_apart, job.request.overwrite = true;
        expect_error([&] { train(job.request); }, {"diverged at step 1 ", "learning_rate"});
        EXPECT_FALSE(job.has(""));
    }
}

TEST(TrainingErrors, NothingIsOverwrittenUnasked) {
    Job job(Codec::strand, {"epochs=2", "width=0.1"});
    train(job.request);
    const std::string before = testing::bytes_of(job.request.output);
    expect_error([&] { train(job.request); }, {"model.h5", "--overwrite"});
    EXPECT_TRUE(before == testing::bytes_of(job.request.output));
    job.request.resume = true;
    train(job.request);  // complete: nothing to do
    EXPECT_TRUE(before == testing::bytes_of(job.request.output));
    EXPECT_NE(job.said.find("complete"), std::string::npos);
    job.request.resume = false;
    job.request.overwrite = true;
    job.request.seed = 4;
    train(job.request);
    EXPECT_FALSE(before == testing::bytes_of(job.request.output));
}

TEST(Training, ResumedWithoutACheckpointBeginsAnewAndSaysSo) {
    Job job(Codec::strand, {"epochs=2", "width=0.1"});
    job.request.resume = true;
    train(job.request);
    EXPECT_TRUE(job.has(""));
    EXPECT_NE(job.said.find("model.h5.checkpoint: no checkpoint"), std::string::npos) << job.said;
}

TEST(TrainingErrors, ACheckpointIsGoneOnFromOnlyWithItsOwnRecipeAndPairs) {
    Job job(Codec::strand, {"epochs=4", "width=0.1"});
    interrupt_after(job.request, 3);
    EXPECT_THROW(train(job.request), Interrupted);
    job.request.progress = nullptr;
    expect_error([&] { train(job.request); }, {".checkpoint", "--resume", "--overwrite"});
    job.request.resume = true;
    job.request.set[0] = "epochs=5";
    expect_error<Misuse>([&] { train(job.request); }, {".checkpoint", "another recipe", "epochs = 5"});
    job.request.set[0] = "epochs=4";
    const std::string pairs = testing::bytes_of(job.request.pairs[0]);
    testing::make_strand_pairs(job.request.pairs[0], 6, 6, 0.01f);
    expect_error([&] { train(job.request); }, {".checkpoint", "other pairs"});
    job.scratch.file("pairs.h5", pairs);
    const std::string checkpoint = testing::bytes_of(job.request.output + ".checkpoint");
    job.scratch.file("model.h5.checkpoint", checkpoint.substr(0, checkpoint.size() / 2));
    expect_error([&] { train(job.request); }, {".checkpoint"});
    job.scratch.file("model.h5.checkpoint", checkpoint);
    train(job.request);
}

TEST(TrainingErrors, PairsThatDoNotFitAreNamed) {
    Job job(Codec::strand, {"epochs=1"});
    job.request.kind = "adhesion";
    expect_error<Misuse>([&] { train(job.request); }, {"pairs.h5", "codec strand"});
    job.request.kind = "sr";
    job.request.architecture = "unet_vgg19";
    expect_error<Misuse>([&] { train(job.request); }, {"unet_vgg19", "strand_mlp"});
    job.request.architecture = "";
    job.request.pairs.push_back(testing::make_root_pairs(job.scratch.path("root.h5")));
    expect_error([&] { train(job.request); }, {"root.h5", "codec root"});
    job.request.pairs = {testing::make_strand_pairs(job.scratch.path("one.h5"), 6, 1)};
    expect_error([&] { train(job.request); }, {"one.h5", "validation"});
    job.request.pairs = {job.scratch.path("absent.h5")};
    expect_error([&] { train(job.request); }, {"absent.h5", "no such file"});
    job.request.pairs = {testing::make_strand_pairs(job.scratch.path("nan.h5"), 6, 4, std::nanf(""))};
    expect_error([&] { train(job.request); }, {"nan.h5", "finite"});
    EXPECT_FALSE(job.has(""));
}

TEST(TrainingErrors, HeldOutFilesThatDoNotFitAreNamed) {
    Job job(Codec::strand, {"epochs=1"});
    job.request.validation = {testing::make_root_pairs(job.scratch.path("root.h5"))};
    expect_error([&] { train(job.request); }, {"root.h5", "codec root"});
    job.request.validation = {job.scratch.path("absent.h5")};
    expect_error([&] { train(job.request); }, {"absent.h5", "no such file"});
    job.request.validation = {testing::make_strand_pairs(job.scratch.path("nan.h5"), 6, 4, std::nanf(""))};
    expect_error([&] { train(job.request); }, {"nan.h5", "finite"});
    Job adhesion(Codec::adhesion, {"epochs=1"});
    adhesion.request.validation = {testing::make_adhesion_pairs(adhesion.scratch.path("other.h5"))};
    expect_error<Misuse>([&] { train(adhesion.request); }, {"adhesion", "--validation"});
    EXPECT_FALSE(job.has("") || adhesion.has(""));
}

TEST(TrainingErrors, ACheckpointIsGoneOnFromOnlyWithItsOwnHeldOutFiles) {
    Job job(Codec::strand, {"epochs=4", "width=0.1"});
    const std::string held = testing::make_strand_pairs(job.scratch.path("held.h5"), 6, 6, 0.02f, 12);
    job.request.validation = {held};
    interrupt_after(job.request, 3);
    EXPECT_THROW(train(job.request), Interrupted);
    job.request.progress = nullptr;
    job.request.resume = true;
    job.request.validation.clear();
    expect_error([&] { train(job.request); }, {".checkpoint", "other pairs"});
    job.request.pairs.push_back(held);
    expect_error([&] { train(job.request); }, {".checkpoint", "other pairs"});
}

TEST(TrainingErrors, AllContactOrAllFreeIsRefused) {
    Job job(Codec::adhesion, {"epochs=1"});
    PairsWriter file(job.request.pairs[0], Codec::adhesion, 12, true);
    file.add(std::vector<AdhesionSample>(50));
    file.commit();
    expect_error([&] { train(job.request); }, {"0 samples in contact", "40 free"});
}

}  // namespace
}  // namespace wetcurl
