// Scenes as they are simulated: what is changed of them, their frames, and which options of `infer` go
// together.
#include <gtest/gtest.h>

#include <algorithm>

#include "app/engine/scene_changes.h"
#include "app/engine/simulated_frames.h"
#include "app/inference/method.h"
#include "app/inference/ways.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

using testing::expect_error;

const std::string text =
    "frames = 3\n[groom]\ngrid = [7, 6]\nparticles = 12\nlength_noise = 0.1\nphase_noise = 3\n[integrator]\n"
    "substeps = 3\nlimiter = 0.1\n[stretch]\n[bend]\n[core]\n[wetness]\njitter = 0.3\n[curl]\n[cohesion]\n"
    "radius = 0.03\n[motion]\nangle = 30\nperiod = 0.5\n[adhesion]\n[[solid]]\nshape = \"sphere\"\nradius = "
    "0.09\nattached = \"head\"\n";

Scene read(const SceneOptions& options = {}) { return parse_scene(text, "scene.toml", ".", options); }

Strands last_frame(const Scene& scene) {
    const auto simulation = make_simulation(scene, "float");
    SimulatedFrames frames(*simulation, scene.frames);
    RunFrame frame;
    while (frames.next(frame)) {
    }
    EXPECT_EQ(frames.index(), scene.frames - 1);
    return frame.seen();
}

void expect_same(const Scene& a, const Scene& b) {
    EXPECT_EQ(a.text, b.text);
    EXPECT_EQ(a.stride, b.stride);
    EXPECT_EQ(a.groom.hash(), b.groom.hash());
    ASSERT_FALSE(a.saturation.empty());
    EXPECT_EQ(a.saturation, b.saturation);
    const Strands one = last_frame(a), other = last_frame(b);
    ASSERT_EQ(one.points.size(), other.points.size());
    for (size_t k = 0; k < one.points.size(); ++k) ASSERT_EQ(norm(one.points[k] - other.points[k]), 0) << k;
}

TEST(SceneChanges, the_low_resolution_twin_is_what_reading_at_twice_the_stride_gives) {
    SceneOptions half, quarter;
    half.stride = 2, quarter.stride = 4;
    const Scene low = low_resolution_of(read());
    EXPECT_EQ(low.groom.rest.count, 4 * 3);
    expect_same(low, read(half));
    expect_same(low_resolution_of(low), read(quarter));
}

TEST(SceneChanges, substeps_and_an_adhesion_model_are_as_if_read) {
    SceneOptions set;
    set.set = {"integrator.substeps=5"};
    Scene scene = read();
    const Strands before = last_frame(scene);
    set_substeps(scene, 5);
    expect_same(scene, read(set));
    EXPECT_GT(norm(before.points.back() - last_frame(scene).points.back()), 1e-7);

    set.set = {"adhesion.model='/somewhere/model.h5'"};
    Scene learned = read();
    set_adhesion_model(learned, "/somewhere/model.h5");
    const Scene wanted = read(set);
    EXPECT_EQ(learned.adhesion_model, wanted.adhesion_model);
    EXPECT_EQ(learned.text, wanted.text);
    EXPECT_EQ(std::count(learned.files.begin(), learned.files.end(), "/somewhere/model.h5"), 1);
}

TEST(SimulatedFrames, begin_with_the_state_at_time_0_and_say_which_frame_diverges) {
    SceneOptions options;
    options.set = {"integrator.kind=explicit", "integrator.substeps=1", "integrator.limiter=0",
                   "stretch.stiffness=1e6", "frames=40"};
    const Scene scene = parse_scene("[groom]\ngrid = [2, 2]\nparticles = 12\n[integrator]\n[stretch]\n",
                                    "scene.toml", ".", options);
    const auto simulation = make_simulation(scene, "double");
    SimulatedFrames frames(*simulation, scene.frames);
    RunFrame frame;
    ASSERT_TRUE(frames.next(frame));
    EXPECT_EQ(frames.index(), 0);
    EXPECT_EQ(frame.seconds, 0);
    expect_error<Diverged>(
        [&] {
            while (frames.next(frame)) {
            }
        },
        {"diverged at frame ", "strand ", "largest term", "substeps"});
}

TEST(SimulatedFrames, end_where_an_edge_is_longer_than_the_scene_allows_and_say_where) {
    SceneOptions options;
    options.set = {"stretch.stiffness=0.2", "integrator.limiter=0"};
    const auto run = [&](double allowed) {
        options.set.push_back("integrator.allow_stretch=" + std::to_string(allowed));
        const Scene scene = read(options);
        const auto simulation = make_simulation(scene, "float");
        SimulatedFrames frames(*simulation, scene.frames);
        RunFrame frame;
        while (frames.next(frame)) {
        }
        return frames.watch().stretch()->value;
    };
    const double most = run(10);
    EXPECT_GT(most, 1.001);
    EXPECT_EQ(run(1.01 * most), most);
    expect_error<Diverged>([&] { run(1 + (most - 1) / 2); },
                           {"diverged at frame ", "strand ", "particle ", "times its rest length",
                            "allow_stretch", "largest term '"});
}

TEST(SimulatedFrames, name_the_solid_that_lies_over_a_root) {
    const Scene scene = parse_scene(
        "[groom]\ngrid = [2, 2]\nparticles = 12\n[stretch]\n[[solid]]\nname = \"ball\"\nradius = 0.4\n",
        "scene.toml", ".");
    const auto simulation = make_simulation(scene, "float");
    SimulatedFrames frames(*simulation, scene.frames);
    RunFrame frame;
    expect_error<Diverged>(
        [&] {
            while (frames.next(frame)) {
            }
        },
        {"times its rest length, its root ", " mm inside the solid 'ball'"});
}

// One option of `infer` each, by its name.
struct Given {
    const char* option;
    void (*give)(InferOptions&);
};
const Given givens[] = {
    {"--reconstruct", [](InferOptions& o) { o.reconstruct = "paper"; }},
    {"--gain", [](InferOptions& o) { o.gain = 2; }},
    {"--units", [](InferOptions& o) { o.units = "printed"; }},
    {"--colour-units", [](InferOptions& o) { o.colour_units = "printed"; }},
    {"--roots 3", [](InferOptions& o) { o.roots = 3; }},
    {"--settled", [](InferOptions& o) { o.settled = true; }},
    {"--crop", [](InferOptions& o) { o.crop = true; }},
    {"--locks", [](InferOptions& o) { o.locks = 7; }},
    {"--wet-shape", [](InferOptions& o) { o.wet_shape = true; }},
    {"--cohesion", [](InferOptions& o) { o.cohesion = true; }},
    {"--passes", [](InferOptions& o) { o.passes = 3; }},
    {"--spacing", [](InferOptions& o) { o.spacing = 0.01; }},
    {"--relaxation", [](InferOptions& o) { o.relaxation = 2; }},
    {"--wetness", [](InferOptions& o) { o.wetness = "wet.toml"; }},
};

// The options that go with a way, as the message of each other one says.
std::vector<std::string> allowed_with(Ways way) {
    std::vector<std::string> out;
    for (const Given& given : givens) {
        InferOptions o;
        given.give(o);
        try {
            require_options_that_go_with(o, way, "this way");
            out.push_back(given.option);
        } catch (const Misuse& e) {
            const std::string said = e.what();
            EXPECT_TRUE(said.starts_with(std::string(given.option) + ": found with this way, allowed with "))
                << said;
            EXPECT_EQ(said.find(text_of(way)), std::string::npos) << said;
        }
    }
    return out;
}

TEST(Infer, each_way_has_its_options_and_refuses_the_others_with_what_they_go_with) {
    using Options = std::vector<std::string>;
    const Options clumping{"--cohesion", "--passes", "--spacing", "--relaxation", "--wetness"};
    const auto with = [&](Options own) {
        own.insert(own.end(), clumping.begin(), clumping.end());
        return own;
    };
    EXPECT_EQ(allowed_with(nearest_way), with({}));
    EXPECT_EQ(allowed_with(quad_way), with({"--roots 3"}));
    EXPECT_EQ(allowed_with(core_way), with({"--roots 3"}));
    EXPECT_EQ(allowed_with(skin_way), with({"--roots 3"}));
    EXPECT_EQ(allowed_with(rest_way), (Options{"--roots 3", "--settled", "--wet-shape", "--cohesion",
                                               "--passes", "--spacing", "--relaxation", "--wetness"}));
    EXPECT_EQ(allowed_with(oracle_weights_way), (Options{"--reconstruct", "--roots 3"}));
    EXPECT_EQ(allowed_with(oracle_colours_way),
              (Options{"--reconstruct", "--gain", "--units", "--colour-units", "--roots 3"}));
    EXPECT_EQ(allowed_with(strands_of_dry_way), with({"--crop", "--locks"}));
    EXPECT_EQ(allowed_with(displayed_of_dry_way), with({"--crop", "--locks"}));
    EXPECT_EQ(allowed_with(strands_of_wet_way), with({"--settled", "--crop", "--locks"}));
    EXPECT_EQ(allowed_with(displayed_of_wet_way), with({"--settled", "--crop", "--locks"}));
    EXPECT_EQ(allowed_with(root_model_way),
              (Options{"--reconstruct", "--gain", "--units", "--roots 3", "--wetness"}));
    EXPECT_EQ(allowed_with(adhesion_model_way), Options{});
}

TEST(Infer, options_become_one_value) {
    InferOptions o;
    o.interpolate = "rest", o.roots = 3, o.wet_shape = true, o.cohesion = true, o.passes = 4;
    check_options(o);
    const Method rest = method_of(o);
    const auto* by = rest.as<InterpolationMethod>();
    ASSERT_NE(by, nullptr);
    EXPECT_EQ(by->kind, Interpolation::rest);
    EXPECT_EQ(by->roots, 3);
    EXPECT_TRUE(by->wet_shape && !by->settled && rest.clumps);
    EXPECT_EQ(rest.clumping.passes, 4);
    EXPECT_EQ(rest.clumping.given(), "--passes");
    o = {};
    o.oracle_colours = "wet.h5", o.reconstruct = "paper", o.units = "printed";
    check_options(o);
    const Method oracle = method_of(o);
    ASSERT_NE(oracle.as<OracleMethod>(), nullptr);
    EXPECT_EQ(oracle.as<OracleMethod>()->transform.form, Reconstruction::paper);
    EXPECT_EQ(oracle.as<OracleMethod>()->transform.units, ShiftUnits::printed);
    EXPECT_FALSE(oracle.as<OracleMethod>()->transform.gain || oracle.clumps);
    EXPECT_EQ(oracle.inputs(), std::vector<std::string>{"wet.h5"});
    // What only the model file says is left open before that is read.
    o = {};
    o.model = "absent.h5", o.crop = true;
    EXPECT_NO_THROW(check_options(o));
    o.wet_shape = true;
    expect_error<Misuse>([&] { check_options(o); },
                         {"--wet-shape: found with a model", "--interpolate rest"});
}

}  // namespace
}  // namespace wetcurl
