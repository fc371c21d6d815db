// Networks on the hair of scenes: dry strands put where wet ones come to rest, crops; adhesion in the loop.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/commands/compare.h"
#include "app/commands/infer.h"
#include "app/commands/simulate.h"
#include "app/engine/learned_hair.h"
#include "app/measures/metrics.h"
#include "base/run_cache.h"
#include "learn/codec/edge_lengths.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

using testing::expect_error;
using testing::Scratch;

// Straight hair that stands off a head, drenched or dry, in as many substeps as the released networks learned
// from.
const std::string standing =
    "frames = 3\n[groom]\ngrid = [8, 8]\nparticles = 25\nlength = 0.1\ncurl_radius = 0\nlift = 0.08\n"
    "[integrator]\nsubsteps = 10\nsettle = 8\n[stretch]\n[bend]\n[core]\n";
const std::string wet = standing + "[wetness]\n[cohesion]\nradius = 0.02\n";

// Of every second root each way.
Settled settled_of_text(const std::string& text, int dry_substeps = 10) {
    const Scene scene = parse_scene(text, "scene", ".");
    return settled_of(scene, "scene", coarsened(scene.groom, 2), dry_substeps, "cpu");
}

double largest(const Strands& a, const Strands& b) {
    double most = 0;
    for (size_t k = 0; k < a.points.size(); ++k)
        most = std::max(most, double(norm(a.points[k] - b.points[k])));
    return most;
}

// The run of every second root each way, as far as its first frame.
std::string low_run(const Scratch& scratch, bool dry, int substeps = 10) {
    SimulateOptions o;
    o.scene = scratch.file("wet.toml", wet);
    o.output = scratch.path((dry ? "dry" : "wet") + std::to_string(substeps) + ".h5");
    o.set = {"integrator.substeps=" + std::to_string(substeps)};
    o.dry = dry, o.before_cohesion = true, o.strands = 16, o.threads = 1;
    simulate_command(o);
    return o.output;
}
Strands first_frame(const std::string& run) { return RunReader(run).frame(0).positions; }

// Offsets from the roots, the head at rest.
Strands from_roots(Strands p) {
    for (int s = 0; s < p.count; ++s)
        for (int i = p.particles - 1; i >= 0; --i) p.at(s, i) -= p.at(s, 0);
    return p;
}
// Where it puts strands.
Strands put(const Settled& settled, Strands p) {
    for (int s = 0; s < p.count; ++s)
        for (int i = 0; i < p.particles; ++i)
            p.at(s, i) = settled.share[size_t(s)] * p.at(s, i) + settled.more.at(s, i);
    return p;
}

TEST(Settled, puts_dry_strands_at_rest_where_wet_ones_rest) {
    const Scratch scratch;
    const Strands drenched = from_roots(first_frame(low_run(scratch, false)));
    for (int substeps : {10, 2}) {
        const Strands dry = from_roots(first_frame(low_run(scratch, true, substeps)));
        EXPECT_GT(largest(dry, drenched), 1e-2);
        EXPECT_LT(largest(put(settled_of_text(wet, substeps), dry), drenched), 1e-6) << substeps;
    }
}

// Gravity is the same all around, and what is said is said in the head's frame. A strand that stands upright
// may fall to another side.
TEST(Settled, turns_with_the_head) {
    const std::string turned = "[motion]\n[[motion.keyframe]]\ntime = 0\nrotation = [0, 90, 0]\n";
    const Settled straight = settled_of_text(wet), around = settled_of_text(wet + turned);
    double apart = 0, sideways = 0;
    for (size_t k = 0; k < straight.more.points.size(); ++k) {
        const Vec3f& p = straight.more.points[k];
        apart += norm(around.more.points[k] - p) / double(straight.more.points.size());
        sideways += std::hypot(p.x, p.z) / double(straight.more.points.size());
    }
    EXPECT_GT(sideways, 1e-3);
    EXPECT_LT(apart, 0.1 * sideways);
}

TEST(Settled, needs_water) {
    expect_error([&] { settled_of_text(standing); }, {"scene", "wet hair", "[wetness]"});
}

// A scene that does not settle by itself is settled for it.
TEST(Settled, is_found_of_scenes_that_do_not_settle) {
    std::string text = wet;
    text.erase(text.find("settle = 8\n"), 11);
    std::string short_time = wet;
    short_time.replace(short_time.find("settle = 8"), 10, "settle = 1.5");
    EXPECT_EQ(largest(settled_of_text(text).more, settled_of_text(short_time).more), 0);
}

// Where little of the hair is wet, that is what a cropped network answers for.
TEST(Infer, cropped_says_the_same_of_wet_strands_and_nothing_of_others_far_from_them) {
    const Scratch scratch;
    low_run(scratch, true);
    scratch.file("part.toml",
                 standing + "[wetness]\npattern = 'region'\ncenter = [0.1, 0, 0]\nradius = 0.1\n");
    const std::vector<uint8_t> is_wet = wet_strands_of(load_scene(scratch.path("part.toml")));
    const auto wet_ones = std::count(is_wet.begin(), is_wet.end(), 1);
    ASSERT_GT(wet_ones, 4);
    ASSERT_LT(wet_ones, 32);
    InferOptions o;
    o.input = scratch.path("dry10.h5"), o.wetness = scratch.path("part.toml"), o.threads = 1;
    o.model = WETCURL_SOURCE_DIR "/models/weights/displayed_s.h5", o.output = scratch.path("whole.h5");
    infer_command(o);
    const Strands whole = first_frame(o.output);
    o.crop = true, o.output = scratch.path("cropped.h5");
    infer_command(o);
    const RunReader run(o.output);
    EXPECT_EQ(run.header().method, "strand_depthwise displayed_s, cropped");
    const Strands cropped = run.frame(0).positions;
    int others = 0;
    for (int s = 0; s < whole.count; ++s) {
        const float apart = norm(cropped.at(s, whole.particles - 1) - whole.at(s, whole.particles - 1));
        if (is_wet[size_t(s)])
            EXPECT_LT(apart, 1e-4) << s;
        else
            others += apart > 1e-3;
    }
    EXPECT_GT(others, 4);
}

TEST(Infer, locks_bring_displayed_strands_together) {
    const Scratch scratch;
    low_run(scratch, true);
    scratch.file("wet.toml", standing + "[wetness]\n[cohesion]\nradius = 0.02\n");
    InferOptions o;
    o.input = scratch.path("dry10.h5"), o.wetness = scratch.path("wet.toml"), o.threads = 1;
    o.model = WETCURL_SOURCE_DIR "/models/weights/displayed_s.h5", o.output = scratch.path("plain.h5");
    infer_command(o);
    o.locks = 7, o.output = scratch.path("locks.h5");
    infer_command(o);
    EXPECT_EQ(RunReader(o.output).header().method, "strand_depthwise displayed_s, locks of 7 passes");
    EXPECT_GT(crowd(first_frame(o.output), 4e-3f), 1.3 * crowd(first_frame(scratch.path("plain.h5")), 4e-3f));
    o.cohesion = true;
    expect_error<Misuse>([&] { infer_command(o); }, {"--locks", "--cohesion", "one of the two"});
    o.cohesion = false, o.device = "cuda";
    expect_error<Misuse>([&] { infer_command(o); }, {"--locks", "--device cuda", "the CPU"});
    o.device = "cpu", o.overwrite = true, scratch.file("wet.toml", standing + "[wetness]\n");
    expect_error([&] { infer_command(o); }, {"wet.toml", "[cohesion]", "locks"});
}

// In the place of neighbours: as many strands come as near, and they stay out of the head.
TEST(Infer, locks_of_networks_of_strands_are_those_of_neighbours) {
    const Scratch scratch;
    low_run(scratch, true);
    const std::string head = "[[solid]]\nname = 'head'\nshape = 'sphere'\nradius = 0.09\nattached = 'head'\n";
    const std::string hair = standing + "[wetness]\n[cohesion]\nradius = 0.02\n";
    scratch.file("wet.toml", hair + head);
    InferOptions o;
    o.input = scratch.path("dry10.h5"), o.wetness = scratch.path("wet.toml"), o.threads = 1;
    o.model = WETCURL_SOURCE_DIR "/models/weights/strand_m.h5", o.output = scratch.path("neighbours.h5");
    infer_command(o);
    o.locks = 10, o.output = scratch.path("locks.h5");  // as many passes as the scene has
    infer_command(o);
    EXPECT_EQ(RunReader(o.output).header().method, "strand_depthwise strand_m, locks of 10 passes");
    const RunFrame neighbours = RunReader(scratch.path("neighbours.h5")).frame(0);
    const Strands before = neighbours.positions, after = neighbours.displayed, locks = first_frame(o.output);
    ASSERT_EQ(after.count, locks.count);
    EXPECT_NEAR(crowd(locks, 4e-3f), crowd(after, 4e-3f), 0.3 * crowd(after, 4e-3f));
    double drawn = 0, apart = 0;
    for (size_t k = 0; k < locks.points.size(); ++k) {
        drawn += norm(after.points[k] - before.points[k]), apart += norm(locks.points[k] - after.points[k]);
        EXPECT_GT(norm(locks.points[k]), 0.09 - 1e-4);
    }
    EXPECT_LT(apart, 0.7 * drawn);

    o.passes = 4, o.overwrite = true;
    expect_error<Misuse>([&] { infer_command(o); },
                         {"--passes", "no Eq 10 by neighbours follows", "--locks"});
    o.passes.reset();
    scratch.file("wet.toml", hair + "[[solid]]\nname = 'wall'\nshape = 'plane'\n");
    expect_error([&] { infer_command(o); }, {"wet.toml", "'wall'", "not attached", "locks by a grid"});
}

// A network that learned from wet runs adds to the rest shape as settled strands carry it.
TEST(Settled, dry_runs_serve_networks_of_wet_ones) {
    const Scratch scratch;
    const std::string dry = low_run(scratch, true), drenched = low_run(scratch, false),
                      weights = WETCURL_SOURCE_DIR "/models/weights/";
    InferOptions o;
    o.input = dry, o.output = scratch.path("rest.h5"), o.threads = 1;
    o.interpolate = "rest", o.settled = true;
    infer_command(o);
    const RunReader rest(o.output);
    EXPECT_EQ(rest.header().method, "rest interpolation, settled");

    const Scene scene = load_scene(scratch.path("wet.toml"));
    const Settled settled = settled_of_text(wet);
    const Strands low = first_frame(dry);
    const auto learned = learned_strands_of(weights + "displayed_m_wet.h5", scene, "wet.toml",
                                            coarsened(scene.groom, 2), 1 / (24.0 * 10), "cpu", 1, &settled);
    Strands out = scene.groom.rest;
    learned->bind(low.points.data(), out.points.data());
    learned->run(HeadWindow());
    Strands carried = rest.frame(0).positions;
    const Strands& drawn = scene.groom.rest;
    for (int s = 0; s < drawn.count; ++s) {
        std::vector<float> length(size_t(drawn.particles), 0);
        for (int i = 1; i < drawn.particles; ++i)
            length[size_t(i)] = norm(drawn.at(s, i) - drawn.at(s, i - 1));
        lead_to_lengths(drawn.particles, length.data(), 1, &carried.at(s, 0));
    }
    EXPECT_LT(largest(learned->base({}), carried), 1e-6);

    o.interpolate.clear(), o.model = weights + "displayed_m_wet.h5", o.output = scratch.path("learned.h5");
    o.json = scratch.path("infer.json"), o.overwrite = true;
    ::testing::internal::CaptureStderr();
    infer_command(o);
    EXPECT_EQ(::testing::internal::GetCapturedStderr().find("learned from wet"), std::string::npos);
    EXPECT_GT(nlohmann::json::parse(testing::bytes_of(o.json))["preparation_seconds"].get<double>(), 0);
    const RunReader run(o.output);
    EXPECT_EQ(run.header().method, "strand_depthwise displayed_m_wet, settled");
    EXPECT_LT(largest(run.frame(0).positions, out), 1e-6);
    // From a scene the dry run is made first.
    o.input = scratch.path("wet.toml"), o.output = scratch.path("from_scene.h5");
    infer_command(o);
    EXPECT_EQ(largest(first_frame(o.output), run.frame(0).positions), 0);
    EXPECT_EQ(RunReader(o.output).header().inputs.at(0),
              o.input + " (simulated dry, 16 strands, 10 substeps a frame)");

    o.input = drenched;
    expect_error<Misuse>([&] { infer_command(o); }, {"--settled", "simulated wet", "a dry run"});
    o.input = dry, o.model = weights + "displayed_s.h5";
    expect_error<Misuse>([&] { infer_command(o); }, {"--settled", "learned from wet runs", "from dry runs"});
    o.model.clear(), o.interpolate = "quad";
    expect_error<Misuse>([&] { infer_command(o); }, {"--settled", "--interpolate rest"});
}

// Scene 15, all of its 280 frames, with a quarter of its strands: wet hair sticks to a ball, is drawn down
// with it and lets go, by Eq 11 and by the released network.
TEST(AdhesionNetworkCoupling, holds_scene_15_as_far_from_the_solids_as_Eq_11) {
    const Scratch scratch;
    SimulateOptions by_eq_11;
    by_eq_11.scene = WETCURL_SOURCE_DIR "/scenes/scene15.toml", by_eq_11.output = scratch.path("eq11.h5");
    by_eq_11.set = {"groom.grid=[8,8]"}, by_eq_11.threads = 1;
    ASSERT_EQ(simulate_command(by_eq_11), 0);
    InferOptions by_network;
    by_network.input = by_eq_11.scene, by_network.output = scratch.path("network.h5");
    by_network.set = by_eq_11.set, by_network.threads = 1;
    ASSERT_EQ(infer_command(by_network), 0);
    CompareOptions o;
    o.reference = by_eq_11.output, o.others = {by_network.output}, o.json = scratch.path("compared.json");
    ASSERT_EQ(compare_command(o), 0);
    const auto found = nlohmann::json::parse(std::ifstream(o.json))["others"][0];
    EXPECT_EQ(found["frames"], 280);
    for (const char* of : {"mean", "p95"}) {
        EXPECT_LT(found["solid_distance_mm"][of].get<double>(), 1) << of;
        EXPECT_LT(found["position_mm"][of].get<double>(), 1) << of;
    }
    // Two ways to the force, not one.
    EXPECT_GT(found["solid_distance_mm"]["max"].get<double>(), 0);
}

}  // namespace
}  // namespace wetcurl
