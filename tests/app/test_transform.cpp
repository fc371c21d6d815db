// Runs of the root codec, from simulation to reconstruction: the gain and units of Eq 18, and what oracles
// make of it.
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "app/commands/encode.h"
#include "app/commands/infer.h"
#include "app/commands/simulate.h"
#include "app/commands/train.h"
#include "app/measures/comparison.h"
#include "base/run_cache.h"
#include "learn/codec/pairs.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

using testing::expect_error;

const std::string wet_curls =
    "frames = 3\n[groom]\ngrid = [8, 8]\nparticles = 25\nlength = 0.1\npitch = 0.04\n[integrator]\n"
    "substeps = 4\nallow_stretch = 1e9\n[stretch]\n[bend]\n[core]\n[wetness]\n[curl]\n[cohesion]\nradius = "
    "0.03\n[motion]\n"
    "angle = 40\nperiod = 0.4\n";

// A dry run of 16 strands and the wet one of 64.
class Transform : public ::testing::Test {
  protected:
    static void SetUpTestSuite() {
        scratch = new testing::Scratch;
        SimulateOptions o;
        o.threads = 1;
        o.scene = scratch->file("scene.toml", wet_curls);
        o.output = wet = scratch->path("wet.h5");
        simulate_command(o);
        o.output = dry = scratch->path("dry.h5");
        o.dry = true, o.strands = 16;
        simulate_command(o);
    }
    static void TearDownTestSuite() { delete scratch; }

    static InferOptions from_dry(const std::string& name) {
        InferOptions o;
        o.input = dry, o.output = scratch->path(name);
        o.overwrite = true, o.threads = 1;
        return o;
    }
    static InferOptions by_colours(double gain, const std::string& form = "paper") {
        InferOptions o = from_dry("colours.h5");
        o.oracle_colours = wet, o.gain = gain, o.reconstruct = form;
        return o;
    }
    static Strands last_of(const InferOptions& o) {
        EXPECT_EQ(infer_command(o), 0);
        return RunReader(o.output).frame(2).positions;
    }
    static double error_mm(const InferOptions& o) {
        infer_command(o);
        return compare_runs(wet, {o.output}, 1).at(0).position_mm.mean;
    }
    static std::string method_of(const InferOptions& o) { return RunReader(o.output).header().method; }

    static inline testing::Scratch* scratch = nullptr;
    static inline std::string dry, wet;
};

TEST_F(Transform, without_gain_is_the_interpolation_bit_for_bit_and_else_moves_as_far_as_the_gain) {
    for (const std::string form : {"paper", "core"}) {
        InferOptions plain = from_dry("plain.h5");
        plain.interpolate = form == "paper" ? "quad" : "core";
        const Strands still = last_of(plain), none = last_of(by_colours(0, form));
        const Strands one = last_of(by_colours(1, form)), three = last_of(by_colours(3, form));
        double most = 0, wrong = 0;
        for (size_t k = 0; k < still.points.size(); ++k) {
            EXPECT_EQ(norm(none.points[k] - still.points[k]), 0);
            const Vec3f shift = one.points[k] - still.points[k];
            most = std::max(most, double(norm(shift)));
            wrong = std::max(wrong, double(norm(three.points[k] - still.points[k] - 3.0f * shift)));
        }
        ASSERT_GT(most, 1e-4) << form;
        EXPECT_LT(wrong, 1e-6) << form;  // positions of 0.3 m are rounded to 3e-8
    }
}

TEST_F(Transform, a_run_says_how_it_was_made_and_that_no_network_made_it) {
    InferOptions o = by_colours(0.5, "core");
    o.units = "printed", o.colour_units = "printed";
    infer_command(o);
    EXPECT_EQ(method_of(o), "oracle colours, core and detail, gain 0.5, Eq 18 as printed, Eq 16 as printed");
    const RunHeader header = RunReader(o.output).header();
    EXPECT_EQ(header.inputs, (std::vector<std::string>{dry, wet}));
    EXPECT_EQ(kind_of(header), "interpolated");
    InferOptions bound = from_dry("bound.h5");
    bound.oracle_weights = wet;
    infer_command(bound);
    EXPECT_EQ(method_of(bound), "oracle weights, core and detail");
}

TEST_F(Transform, no_gain_of_the_true_colours_comes_nearer_than_the_best_weights) {
    InferOptions o = from_dry("bound.h5");
    o.oracle_weights = wet;
    for (const std::string form : {"paper", "core"}) {
        o.reconstruct = form;
        const double bound = error_mm(o);
        double best = std::numeric_limits<double>::max();
        for (double gain : {0.0, 1.0, 10.0, 100.0}) best = std::min(best, error_mm(by_colours(gain, form)));
        EXPECT_LT(bound, best);
        EXPECT_GT(bound, 0.1);  // [mm]
    }
}

TEST_F(Transform, colours_as_printed_are_others) {
    InferOptions o = by_colours(1);
    const Strands read = last_of(o);
    o.colour_units = "printed";
    const Strands printed = last_of(o);
    double most = 0;
    for (size_t k = 0; k < read.points.size(); ++k)
        most = std::max(most, double(norm(read.points[k] - printed.points[k])));
    EXPECT_GT(most, 1e-4);
}

TEST_F(Transform, a_model_keeps_the_gain_that_its_recipe_names) {
    EncodeOptions encode;
    encode.inputs = {dry, wet}, encode.codec = "root", encode.colour_units = "length";
    encode.output = scratch->path("pairs.h5"), encode.threads = 1;
    encode_command(encode);
    EXPECT_EQ(PairsReader(encode.output).text("colour_units"), "length");
    TrainOptions train;
    train.kind = "sr", train.pairs = {encode.output}, train.architecture = "recursive_residual";
    train.width = 0.01, train.threads = 1, train.output = scratch->path("model.h5");
    train.set = {"epochs=1", "batch=1", "patch=32", "reconstruct.gain=7", "reconstruct.units=printed"};
    train_command(train);
    InferOptions o = from_dry("learned.h5");
    o.model = train.output, o.reconstruct = "paper";
    // So read, it throws strands about, which a run refuses whose scene does not ask for it, now and when it
    // is gone on with.
    SimulateOptions strict;
    strict.threads = 1, strict.scene = scratch->path("scene.toml"), strict.dry = true, strict.strands = 16;
    strict.set = {"integrator.allow_stretch=10"}, strict.output = scratch->path("strict.h5");
    simulate_command(strict);
    InferOptions refused = o;
    refused.input = strict.output, refused.output = scratch->path("refused.h5");
    for (const bool resumed : {false, true}) {
        refused.resume = resumed, refused.overwrite = !resumed;
        expect_error([&] { infer_command(refused); },
                     {"refused.h5", "diverged at frame 0", "times its rest length", "allow_stretch",
                      "gain 7, Eq 18 as printed", "0 frames are kept"});
    }
    refused.resume = false, refused.overwrite = true, refused.set = {"fps=30"};
    expect_error<Misuse>([&] { infer_command(refused); }, {"--set fps=30"});
    refused.set = {"integrator.allow_stretch=1e9"};
    EXPECT_EQ(infer_command(refused), 0);
    infer_command(o);
    EXPECT_EQ(method_of(o), "recursive_residual, paper, gain 7, Eq 18 as printed");
    o.units = "length", o.gain = 0;
    const Strands none = last_of(o);
    EXPECT_EQ(method_of(o), "recursive_residual, paper, gain 0");
    InferOptions plain = from_dry("plain.h5");
    plain.interpolate = "quad";
    EXPECT_EQ(norm(none.at(20, 24) - last_of(plain).at(20, 24)), 0);
    // A scene's [learned] goes before the model's, the command line before both.
    const std::string scene = scratch->file(
        "learned.toml", wet_curls + "[learned]\nmodel = \"model.h5\"\ngain = 4\nunits = \"length\"\n");
    InferOptions of_scene = from_dry("scene.h5");
    of_scene.input = scene;
    infer_command(of_scene);
    EXPECT_EQ(method_of(of_scene), "recursive_residual, core and detail, gain 4");
    of_scene.gain = 2;
    infer_command(of_scene);
    EXPECT_EQ(method_of(of_scene), "recursive_residual, core and detail, gain 2");
}

TEST_F(Transform, what_has_no_meaning_is_refused) {
    auto refused = [](InferOptions o, std::initializer_list<std::string> said) {
        expect_error<Misuse>([&] { infer_command(o); }, said);
    };
    InferOptions o = by_colours(1);
    o.oracle_weights = wet;
    refused(o, {"one of", "--oracle-weights"});
    o.oracle_colours = "", o.gain = 2;
    refused(o, {"--gain", "--oracle-colours"});
    o = by_colours(1e9), o.units = "printed";
    expect_error([&] { infer_command(o); },
                 {"gain 1e+09, Eq 18 as printed", "beyond 1e6 m", "gain of Eq 18"});
    o = by_colours(1), o.cohesion = true;
    refused(o, {"oracle", "--cohesion"});
    o = by_colours(1), o.wetness = scratch->path("scene.toml");
    refused(o, {"oracle", "--wetness"});
    o = from_dry("out.h5"), o.interpolate = "quad", o.gain = 1;
    refused(o, {"--gain", "root codec"});
    o = from_dry("out.h5"), o.interpolate = "quad", o.colour_units = "length";
    refused(o, {"--colour-units", "--oracle-colours"});
    o = from_dry("out.h5"), o.model = WETCURL_SOURCE_DIR "/models/weights/displayed_s.h5", o.gain = 1;
    refused(o, {"--gain", "whole strands"});
    o = by_colours(1), o.oracle_colours = dry;
    expect_error([&] { infer_command(o); }, {"simulated wet"});
    EncodeOptions encode;
    encode.inputs = {dry, wet}, encode.colour_units = "printed", encode.output = scratch->path("no.h5");
    expect_error<Misuse>([&] { encode_command(encode); }, {"--colour-units", "--codec root"});
}

// A high-resolution run without water has the right grid, and is no truth.
TEST_F(Transform, an_oracle_is_a_wet_run) {
    SimulateOptions simulate;
    simulate.scene = scratch->path("scene.toml"), simulate.output = scratch->path("dry_high.h5");
    simulate.dry = true, simulate.threads = 1;
    simulate_command(simulate);
    InferOptions o = by_colours(1);
    o.oracle_colours = simulate.output;
    expect_error([&] { infer_command(o); }, {"dry_high.h5", "simulated dry", "simulated wet"});
}

}  // namespace
}  // namespace wetcurl
