// The CUDA backend against the CPU's. Without a device each test says SKIP and why.
#include <gtest/gtest.h>

#include "cuda/rates.h"
#include "cuda/simulation.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;

class Cuda : public ::testing::Test {
  protected:
    void SetUp() override {
        std::string reason;
        if (cuda_devices(&reason).empty()) GTEST_SKIP() << "SKIP: no CUDA device (" << reason << ")";
    }
    static RunFrame on_device(const Scene& scene, int frames, const std::string& precision = "float") {
        const auto simulation = make_cuda_simulation(scene, precision, 0);
        for (int f = 0; f < frames; ++f) simulation->advance();
        EXPECT_FALSE(simulation->divergence());
        RunFrame frame;
        simulation->snapshot(frame);
        return frame;
    }
};

struct Case {
    const char* name;
    std::string text;
    std::vector<std::string> set;
    bool creases =
        false;  // between solids, where a rounding decides which one holds, on few strands: over one frame
};
// All that a scene may name.
std::vector<Case> cases() {
    const std::string grid = "groom.grid=[6, 6]",
                      attached = "[[solid]]\nradius = 0.097\nattached = \"head\"\n";
    const std::string others =
        "[[solid]]\nshape = \"capsule\"\nradius = 0.03\n[[solid.motion.keyframe]]\ntranslation = [0, 0, "
        "-0.1]\n"
        "[[solid]]\nshape = \"box\"\nhalf = [0.02, 0.05, 0.02]\n[[solid.motion.keyframe]]\ntranslation = "
        "[0.05, 0, -0.12]\n";
    return {{"dry", dry_scene, {grid}},
            {"wet", wet_scene, {grid}},
            {"wet, attached head", wet_scene + attached, {grid}},
            {"wet, other solids", wet_scene + others, {grid}, true},
            {"odd substeps", wet_scene, {grid, "integrator.substeps=5"}},
            {"settled", dry_scene, {grid, "integrator.settle=0.3"}},
            {"limited", dry_scene, {grid, "integrator.limiter=0.02", "stretch.stiffness=0.5"}}};
}

TEST_F(Cuda, one_frame_is_the_cpus) {
    for (const auto& c : cases()) {
        const Scene scene = scene_of(c.text, c.set);
        const RunFrame wanted = after(scene, 1), got = on_device(scene, 1);
        ASSERT_GT(farthest(wanted.positions, scene.groom.rest), 1e-4) << c.name;
        // Ten float ulps at 0.25 m, a few times over for substeps of a stiff chain. A rounding decides for
        // some strands which particles a surface holds, and whether forces are taken anew.
        const double bound = c.creases ? 1e-4 : 3e-6;
        const int astray = scene.solids.empty() ? 0 : 8;
        EXPECT_LE(strands_astray(got.positions, wanted.positions, bound), astray) << c.name;
        // They draw their neighbours along.
        if (scene.cohesion) {
            EXPECT_LE(strands_astray(got.displayed, wanted.displayed, 3 * bound), 4 * astray) << c.name;
        }
    }
}

TEST_F(Cuda, in_double_precision_frames_are_the_cpus) {
    for (const auto& c : cases()) {
        const Scene scene = scene_of(c.text, c.set);
        const int frames = c.creases ? 1 : 24;
        const RunFrame wanted = after(scene, frames, "double"), got = on_device(scene, frames, "double");
        ASSERT_GT(farthest(wanted.positions, scene.groom.rest), 1e-4) << c.name;
        EXPECT_LT(farthest(got.positions, wanted.positions), 1e-6) << c.name;
        EXPECT_EQ(got.contact, wanted.contact) << c.name;
        if (scene.cohesion) {
            EXPECT_LT(farthest(got.displayed, wanted.displayed), 1e-5) << c.name;
        }
    }
}

// Their room lies in the device's memory.
TEST_F(Cuda, strands_too_long_for_a_processor_are_the_cpus) {
    const Scene scene = scene_of(dry_scene, {"groom.grid=[2, 3]", "groom.particles=600", "bend.torsion=0"});
    const RunFrame wanted = after(scene, 2, "double"), got = on_device(scene, 2, "double");
    ASSERT_GT(farthest(wanted.positions, scene.groom.rest), 1e-4);
    EXPECT_LT(farthest(got.positions, wanted.positions), 1e-6);
}

TEST_F(Cuda, in_single_precision_24_frames_stay_near_the_double_ones) {
    for (const auto& c : cases()) {
        const Scene scene = scene_of(c.text, c.set);
        // Where hair sticks and lets go, or is limited, the CPU's own single precision strays by millimetres.
        if (scene.term<Adhesion>() || scene.term<StrainLimit>()) continue;
        const Strands wanted = after(scene, 24, "double").positions, got = on_device(scene, 24).positions;
        // A rounding may decide for a strand that forces are taken anew.
        EXPECT_LE(strands_astray(got, wanted, 1e-4), 1) << c.name;
        EXPECT_LT(farthest(got, wanted), 1e-3) << c.name;
    }
}

TEST_F(Cuda, a_run_repeats_to_the_bit) {
    for (const auto& c : cases()) {
        const Scene scene = scene_of(c.text, c.set);
        const RunFrame a = on_device(scene, 24), b = on_device(scene, 24);
        EXPECT_TRUE(same_bits(a.positions, b.positions)) << c.name;
        EXPECT_TRUE(same_bits(a.seen(), b.seen())) << c.name;
        EXPECT_EQ(a.energy, b.energy) << c.name;
    }
}

TEST_F(Cuda, energies_are_the_cpus) {
    const Scene scene = scene_of(wet_scene);
    const auto cpu = make_simulation(scene, "double"), gpu = make_cuda_simulation(scene, "double", 0);
    EXPECT_EQ(cpu->energy_kinds, gpu->energy_kinds);
    RunFrame a, b;
    for (int f = 0; f < 4; ++f) cpu->advance(), gpu->advance();
    cpu->snapshot(a), gpu->snapshot(b);
    ASSERT_EQ(a.energy.size(), b.energy.size());
    for (size_t k = 0; k < a.energy.size(); ++k)
        EXPECT_NEAR(a.energy[k], b.energy[k], 1e-4 * std::abs(a.energy[k]) + 1e-12) << cpu->energy_kinds[k];
    EXPECT_NEAR(cpu->neighbours_mean(), gpu->neighbours_mean(), 0.02 * cpu->neighbours_mean());
    EXPECT_GT(gpu->neighbours_mean(), 1);
}

TEST_F(Cuda, cohesion_of_a_dense_groom_is_the_cpus) {
    for (const char* coherence : {"cohesion.coherence=0", "cohesion.coherence=0.01"})
        for (const char* particles : {"groom.particles=24", "groom.particles=100"}) {
            const Scene scene = scene_of(wet_scene, {"groom.grid=[16, 16]", "cohesion.radius=0.012",
                                                     "cohesion.passes=10", coherence, particles});
            const RunFrame wanted = after(scene, 0), got = on_device(scene, 0);
            ASSERT_GT(farthest(wanted.displayed, wanted.positions), 1e-3);
            EXPECT_LT(farthest(got.positions, wanted.positions), 1e-7);
            // Ten passes of sums in another order.
            EXPECT_LT(farthest(got.displayed, wanted.displayed), 1e-5) << coherence << ' ' << particles;
        }
}

TEST_F(Cuda, what_is_not_covered_is_refused) {
    EXPECT_THROW(make_cuda_simulation(scene_of(dry_scene + "[air]\n"), "float", 0), Error);
    EXPECT_THROW(make_cuda_simulation(scene_of(wet_scene + "[wetness.flow]\n"), "float", 0), Error);
    expect_error([] { make_cuda_simulation(scene_of(dry_scene, {"baseline.method='iben'"}), "float", 0); },
                 {"--device cpu", "iben"});
    for (const char* kind : {"integrator.kind='explicit'", "integrator.kind='backward_euler'"})
        EXPECT_THROW(make_cuda_simulation(scene_of(dry_scene, {kind}), "float", 0), Error) << kind;
    EXPECT_THROW(make_cuda_simulation(scene_of(dry_scene), "float", 99), Error);
    const Scene scene = scene_of(wet_scene);
    const auto simulation = make_cuda_simulation(scene, "float", 0);
    std::vector<AdhesionRecord> records;
    EXPECT_THROW(simulation->record_adhesion(&records), Error);
}

TEST_F(Cuda, rates_are_those_of_a_gpu) {
    const CudaRates rates = measured_cuda_rates(0);
    // No device that this backend is built for is this slow, nor ten times as fast as today's.
    EXPECT_GT(rates.copy_bytes, 1e11);
    EXPECT_LT(rates.copy_bytes, 1e14);
    EXPECT_GT(rates.operations, 1e12);
    EXPECT_LT(rates.operations, 1e15);
}

TEST_F(Cuda, a_run_that_blows_up_is_seen) {
    const Scene scene = scene_of(wet_scene, {"integrator.gravity=[0, -1e5, 0]", "stretch.stiffness=0.001"});
    const auto cpu = make_simulation(scene, "float"), gpu = make_cuda_simulation(scene, "float", 0);
    for (int f = 0; f < 10 && !cpu->divergence(); ++f) cpu->advance(), gpu->advance();
    const auto wanted = cpu->divergence(), found = gpu->divergence();
    ASSERT_TRUE(wanted);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->strand, wanted->strand);
    EXPECT_EQ(found->largest_term, wanted->largest_term);
}

// Without a device too.
TEST(CudaDevices, one_that_is_not_there_is_an_error) { EXPECT_THROW(require_cuda_device(1000), Error); }

}  // namespace
}  // namespace wetcurl
