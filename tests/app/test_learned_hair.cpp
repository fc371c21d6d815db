// Where wet strands come to rest from dry ones, and what starts from there.
// Ours.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/learned_hair.h"
#include "base/run_cache.h"
#include "learn/network_module.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

using testing::expect_error;
using testing::Scratch;

// Straight hair that stands off a head, drenched or dry.
const std::string standing =
    "frames = 3\n[groom]\ngrid = [8, 8]\nparticles = 25\nlength = 0.1\ncurl_radius = 0\nlift = 0.08\n"
    "[integrator]\nsubsteps = 4\nsettle = 8\n[stretch]\n[bend]\n[core]\n";
const std::string wet = standing + "[wetness]\n[cohesion]\nradius = 0.02\n";

Strands settled_of_text(const std::string& text) {
    const Scene scene = parse_scene(text, "scene", ".");
    return settled_of(scene, scene, "cpu");
}

double largest(const Strands& a, const Strands& b) {
    double most = 0;
    for (size_t k = 0; k < a.points.size(); ++k)
        most = std::max(most, double(norm(a.points[k] - b.points[k])));
    return most;
}

TEST(Settled, is_how_far_wet_strands_rest_from_dry_ones) {
    Scratch scratch;
    auto first = [&](bool dry) {
        SimulateOptions o;
        o.scene = scratch.file("wet.toml", wet);
        o.output = scratch.path(dry ? "dry.h5" : "wet.h5");
        o.dry = dry, o.threads = 1;
        simulate_command(o);
        return RunReader(o.output).frame(0).positions;
    };
    const Strands dry = first(true), drenched = first(false), settled = settled_of_text(wet);
    Strands apart = drenched;
    double lower = 0;
    for (size_t k = 0; k < apart.points.size(); ++k) apart.points[k] -= dry.points[k];
    EXPECT_LT(largest(settled, apart), 1e-6);
    for (int s = 0; s < settled.count; ++s) {
        EXPECT_EQ(norm(settled.at(s, 0)), 0);
        lower += double(settled.at(s, 24).y) / settled.count;
    }
    EXPECT_LT(lower, -1e-3);  // water is heavy
}

// Gravity is the same all around, and what is said is said in the head's frame. A strand that stands upright
// may fall to another side.
TEST(Settled, turns_with_the_head) {
    const std::string turned = "[motion]\n[[motion.keyframe]]\ntime = 0\nrotation = [0, 90, 0]\n";
    const Strands straight = settled_of_text(wet), around = settled_of_text(wet + turned);
    double apart = 0, sideways = 0;
    for (size_t k = 0; k < straight.points.size(); ++k) {
        const Vec3f& p = straight.points[k];
        apart += norm(around.points[k] - p) / double(straight.points.size());
        sideways += std::hypot(p.x, p.z) / double(straight.points.size());
    }
    EXPECT_GT(sideways, 1e-3);
    EXPECT_LT(apart, 0.1 * sideways);
}

TEST(Settled, needs_water) {
    expect_error([&] { settled_of_text(standing); }, {"come to rest", "[wetness]"});
}

// A scene that does not settle by itself is settled for it.
TEST(Settled, is_found_of_scenes_that_do_not_settle) {
    std::string text = wet;
    text.erase(text.find("settle = 8\n"), 11);
    std::string short_time = wet;
    short_time.replace(short_time.find("settle = 8"), 10, "settle = 1.5");
    EXPECT_EQ(largest(settled_of_text(text), settled_of_text(short_time)), 0);
}

// A network of settled strands adds to the rest shape as they carry it.
TEST(Settled, a_network_starts_from_there) {
    Scratch scratch;
    SimulateOptions simulate;
    simulate.scene = scratch.file("wet.toml", wet);
    simulate.output = scratch.path("wet.h5"), simulate.threads = 1;
    simulate_command(simulate);
    const std::string high = simulate.output;
    simulate.output = scratch.path("low.h5"), simulate.dry = true, simulate.strands = 16;
    simulate_command(simulate);

    EncodeOptions encode;
    encode.inputs = {simulate.output, high};
    encode.output = scratch.path("pairs.h5"), encode.settled = true;
    encode_command(encode);
    TrainRequest train;
    train.kind = "sr", train.pairs = {encode.output}, train.output = scratch.path("model.h5");
    train.set = {"epochs=1", "width=0.1"}, train.threads = 1;
    network_module().train(train);
    EXPECT_EQ(network_module().card(train.output).low, "settled");

    InferOptions o;
    o.input = simulate.output, o.output = scratch.path("rest.h5"), o.threads = 1;
    o.interpolate = "rest", o.settled = true;
    infer_command(o);
    const RunReader rest(o.output);
    EXPECT_EQ(rest.header().method, "rest interpolation, settled");

    const Scene scene = load_scene(simulate.scene);
    const Groom low = coarsened(scene.groom, 2);
    const auto learned = learned_strands_of(train.output, scene, simulate.scene, low, "cpu", 1);
    const RunFrame frame = RunReader(simulate.output).frame(0);
    Strands out = scene.groom.rest;
    learned->bind(frame.positions.points.data(), out.points.data());
    learned->run(HeadWindow());
    EXPECT_LT(largest(learned->base(frame.head), rest.frame(0).positions), 1e-6);

    o.interpolate = "quad", o.overwrite = true;
    expect_error<Misuse>([&] { infer_command(o); }, {"--settled", "--interpolate rest"});
    o.interpolate.clear(), o.model = train.output;
    expect_error<Misuse>([&] { infer_command(o); }, {"--settled", "models say themselves"});
    // Told of another run, it says so; of the right one it says nothing, and how long it took to find.
    o.settled = false, o.json = scratch.path("infer.json");
    auto infer = [&](const std::string& input) {
        o.input = input;
        ::testing::internal::CaptureStderr();
        infer_command(o);
        return ::testing::internal::GetCapturedStderr();
    };
    EXPECT_EQ(infer(simulate.output).find("learned from"), std::string::npos);
    EXPECT_GT(nlohmann::json::parse(testing::bytes_of(o.json))["preparation_seconds"].get<double>(), 0);
    simulate.dry = false, simulate.overwrite = true;
    simulate_command(simulate);
    EXPECT_NE(infer(simulate.output).find("simulated wet"), std::string::npos);
    o.model.clear(), o.interpolate = "rest", o.settled = true;
    expect_error<Misuse>([&] { infer_command(o); }, {"--settled", "simulated wet", "a dry run"});
}

}  // namespace
}  // namespace wetcurl
