// What `wetcurl bench` measures is what it says; nothing here is judged by its time.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "app/bench/bench.h"
#include "app/bench/bench_operations.h"
#include "app/bench/flop_counter.h"
#include "app/commands/bench.h"
#include "app/files/results.h"
#include "base/vec3.h"
#include "solver/run/simulation.h"
#include "tests/base/scratch.h"

namespace wetcurl::bench {
namespace {

using wetcurl::testing::bytes_of;
using wetcurl::testing::expect_error;
using wetcurl::testing::Scratch;

const Workload tiny{4, 4, 0.03, 0.1, 4, 50};

TEST(Bench, gives_the_keys_that_others_rely_on) {
    const Scratch scratch;
    BenchOptions o;
    o.filter = "brute force, 1000";
    o.json = scratch.path("bench.json");
    EXPECT_EQ(bench_command(o), 0);
    const Json json = Json::parse(bytes_of(o.json));
    EXPECT_GT(json.at("machine").at("copy_bytes_per_second").get<double>(), 1e8);
    EXPECT_GT(json.at("machine").at("operations_per_second").get<double>(), 1e8);
    EXPECT_GT(json.at("machine").at("peak_bytes").get<double>(), 1e6);
    EXPECT_TRUE(json.at("error_against_time").empty());
    const Json& entries = json.at("entries");
    ASSERT_EQ(entries.size(), 1u);
    const Json& e = entries[0];
    EXPECT_EQ(e.at("device"), "cpu");
    for (const char* absent : {"strands", "particles_per_strand", "operations", "share_of_arithmetic_rate",
                               "bytes_per_particle", "neighbours_mean", "error_mm"})
        EXPECT_TRUE(e.at(absent).is_null()) << absent;
    const Json& t = e.at("milliseconds");
    EXPECT_LE(t.at("min").get<double>(), t.at("median").get<double>());
    EXPECT_LE(t.at("median").get<double>(), t.at("max").get<double>());
    for (const char* there : {"items_per_second", "bytes", "share_of_copy_bandwidth", "repetitions"})
        EXPECT_GT(e.at(there).get<double>(), 0) << there;
}

TEST(Bench, refuses_a_filter_that_no_entry_holds_and_a_device_that_is_not_there) {
    BenchOptions o;
    o.filter = "gird";
    expect_error<Misuse>([&] { bench_command(o); }, {"--filter", "gird", "neighbour search by grid",
                                                     "wet frame", "error against run time"});
    o.filter = "";
    o.device = "cuda:4096";
    expect_error([&] { bench_command(o); }, {"--device cuda"});
}

TEST(Bench, the_fixed_workload_is_the_demo) {
    SceneOptions options;
    options.set = {"groom.grid=[4, 4]", "groom.particles=50", "cohesion.passes=10", "cohesion.radius=0.03",
                   "integrator.settle=0.1"};
    const Scene demo = load_scene(WETCURL_SOURCE_DIR "/scenes/demo.toml", options),
                ours = scene_of(tiny, true);
    RunFrame a, b;
    for (auto [scene, frame] : {std::pair{&demo, &a}, {&ours, &b}}) {
        const auto simulation = make_simulation(*scene, "float");
        simulation->advance();
        simulation->snapshot(*frame);
    }
    ASSERT_EQ(a.displayed.points.size(), 16u * 50);
    ASSERT_EQ(b.displayed.points.size(), 16u * 50);
    for (size_t k = 0; k < a.displayed.points.size(); ++k)
        ASSERT_EQ(norm(a.displayed.points[k] - b.displayed.points[k]), 0) << k;
}

TEST(Bench, a_frame_has_a_line_and_each_of_its_stages_another) {
    const auto wet = whole_frames(tiny, true, "cpu", true), dry = whole_frames(tiny, false, "cpu", false);
    std::string names;
    for (const auto* lines : {&wet, &dry})
        for (const Line& line : *lines) {
            names += line.name + "; ";
            EXPECT_EQ(line.strands, 16);
            EXPECT_EQ(line.items, 16 * 50);
            EXPECT_EQ(line.seconds.count, 2u);  // of frames 2 and 3
            EXPECT_GT(line.seconds.min, 0) << line.name;
            EXPECT_GT(line.bytes, 800 * 10) << line.name;
        }
    EXPECT_EQ(names,
              "wet frame, 16 strands; wet frame, 16 strands: chain; wet frame, 16 strands: neighbours; "
              "wet frame, 16 strands: cohesion; dry frame, 16 strands; dry frame, 16 strands: chain; ");
    EXPECT_GT(wet[0].error_mm.value(), 1e-3);
    EXPECT_FALSE(dry[0].error_mm || dry[0].neighbours);
    EXPECT_GT(wet[0].neighbours.value(), 1);
    EXPECT_GT(wet[0].bytes_a_particle.value(), dry[0].bytes_a_particle.value());
    EXPECT_FALSE(wet[0].operations || wet[2].operations);
    EXPECT_EQ(dry[0].operations, dry[1].operations);  // of its only stage
    EXPECT_GT(wet[3].operations.value(), 1e4);
    // A strand's matrix alone takes hundreds for each particle and substep.
    EXPECT_GT(dry[1].operations.value(), 800 * 10 * 300.0);
    EXPECT_LT(dry[1].operations.value(), 800 * 10 * 30000.0);
}

// The same hair, which hangs still and so is nearer to the reference than under a head that turns.
TEST(Bench, a_head_at_rest_has_lines_of_its_own) {
    Workload at_rest = tiny;
    at_rest.angle = 0;
    const auto turns = whole_frames(tiny, true, "cpu", true),
               rests = whole_frames(at_rest, true, "cpu", true);
    EXPECT_EQ(rests[0].name, "wet frame, head at rest, 16 strands");
    EXPECT_EQ(rests[0].series, "wet frame, head at rest");
    EXPECT_LT(rests[0].error_mm.value(), turns[0].error_mm.value());
}

TEST(Bench, has_a_frame_for_each_stage_that_a_scene_may_name) {
    for (const auto& [filter, stage] :
         std::map<std::string, std::string>{{"with flow, 64", "saturation"},
                                            {"with strand contact, 64", "strand contact"},
                                            {"with adhesion, 64", "chain"},
                                            {"with cohesion in the solve, 64", "cohesion in the solve"},
                                            {"with Lin 2015, 64", "baseline"},
                                            {"with Kim 2016, 64", "baseline"},
                                            {"with boundary particles, 64", "baseline"}}) {
        const auto all = frame_entries("cpu");
        const auto entry = std::find_if(all.begin(), all.end(), [&, &filter = filter](const Entry& e) {
            return e.names[0].find("frame " + filter + " strands") != std::string::npos;
        });
        ASSERT_NE(entry, all.end()) << filter;
        Results results;
        entry->measure(results);
        ASSERT_EQ(results.lines.size(), 2u) << filter;
        for (size_t k = 0; k < 2; ++k) {
            EXPECT_EQ(results.lines[k].name, entry->names[k]);
            EXPECT_GT(results.lines[k].seconds.min, 0) << filter;
            EXPECT_GT(results.lines[k].bytes, 6400 * 4) << filter;
        }
        EXPECT_EQ(results.lines[1].name, results.lines[0].name + ": " + stage);
        EXPECT_LT(results.lines[1].seconds.min, results.lines[0].seconds.min);
    }
}

TEST(Bench, error_falls_with_substeps_and_what_diverges_has_none) {
    const auto bdf2 = error_against_time(tiny, "cpu", "implicit", "double", {2, 40, 160});
    ASSERT_EQ(bdf2.size(), 3u);
    EXPECT_EQ(bdf2[0].integrator, "BDF2");
    EXPECT_EQ(bdf2[0].precision, "double");
    EXPECT_EQ(bdf2[1].substeps, 40);
    EXPECT_GT(bdf2[0].error_mm.value(), bdf2[1].error_mm.value());
    EXPECT_GT(bdf2[1].error_mm.value(), 1e-4);
    EXPECT_EQ(bdf2[2].error_mm.value(), 0);  // the reference itself
    const auto euler = error_against_time(tiny, "cpu", "backward_euler", "float", {40});
    EXPECT_GT(euler.at(0).error_mm.value(), bdf2[1].error_mm.value());
    const auto printed = error_against_time(tiny, "cpu", "explicit", "float", {2, 2560, 5120});
    ASSERT_EQ(printed.size(), 2u);  // the first that stands is the last
    EXPECT_FALSE(printed[0].error_mm);
    EXPECT_GT(printed[1].error_mm.value(), 0);
}

TEST(Counted, counts_sums_products_quotients_and_roots) {
    const Vec3<Counted> a{1, 2, 2};
    Counted::operations = 0;
    EXPECT_EQ(norm(a)[0], 3);
    EXPECT_EQ(Counted::operations, 6);
    EXPECT_EQ(select(Counted(2) < Counted(1), a, -a).x[0], -1);
    EXPECT_EQ(Counted::operations, 6);
    Counted sum = Counted(1) / Counted(4);
    sum += Counted(1);
    EXPECT_EQ(sum[0], 1.25f);
    EXPECT_EQ(Counted::operations, 8);
}

TEST(Counted, operations_of_eq_10_grow_with_neighbours_alone) {
    Cohesion term{};
    term.h_c = 0.01, term.lambda = 0.85, term.coherence = 0.01;
    const double none = cohesion_operations(term, 0), one = cohesion_operations(term, 1);
    EXPECT_GT(none, 0);
    // Difference, distance, kernel, two sums of Eq 10.
    EXPECT_EQ(one - none, 3 + 6 + 12 + 7 + 2);
    EXPECT_EQ(cohesion_operations(term, 30) - none, 30 * (one - none));
}

}  // namespace
}  // namespace wetcurl::bench
