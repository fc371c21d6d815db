// The CUDA backend against the CPU's.
#include <gtest/gtest.h>

#include <thread>

#include "cuda/device/cuda_owners.h"
#include "cuda/device/rates.h"
#include "cuda/run/simulation.h"
#include "cuda/solids/level_set_kernel.h"
#include "solver/pair_forces/pair_forces_coupling.h"
#include "tests/cuda/dense_adhesion.h"
#include "tests/cuda/needs_device.h"
#include "tests/solver/characters.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;

class Cuda : public testing::NeedsDevice {
  public:
    static RunFrame on_device(const Scene& scene, int frames, const std::string& precision = "float",
                              Stepping stepping = Stepping::chosen) {
        const auto simulation = make_cuda_simulation(scene, precision, 0, stepping);
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
            {"fibre", as_fibre(dry_scene), {grid}},
            {"wet fibre", as_fibre(wet_scene), {grid}},
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

// Their workspace lies in the device's memory.
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
        // A rounding may decide for a strand that forces are taken anew; in a build for parity for two, there
        // as on the CPU.
        EXPECT_LE(strands_astray(got, wanted, 1e-4), 2) << c.name;
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

TEST_F(Cuda, frames_that_are_not_shown_change_none_that_are) {
    for (const auto& c : cases()) {
        const Scene scene = scene_of(c.text, c.set);
        const auto simulation = make_cuda_simulation(scene, "float", 0);
        RunFrame some, before;
        for (int f = 1; f <= 6; ++f) {
            simulation->advance(f == 2 || f == 6);
            if (f == 2) simulation->snapshot(before);
            if (f == 4) simulation->snapshot(some);
        }
        if (scene.cohesion) {
            EXPECT_TRUE(same_bits(some.displayed, before.displayed)) << c.name;
        }
        simulation->snapshot(some);
        const RunFrame all = on_device(scene, 6);
        EXPECT_TRUE(same_bits(some.positions, all.positions)) << c.name;
        EXPECT_TRUE(same_bits(some.seen(), all.seen())) << c.name;
    }
}

// As `simulate` does: a frame is fetched by another thread after the next one has begun.
TEST_F(Cuda, frames_fetched_while_the_next_is_computed_are_those_of_their_time) {
    for (const auto& text : {wet_scene, flowing_scene(0, 1e6)}) {
        const Scene scene = scene_of(text, {"groom.grid=[12, 12]"});
        const auto early = make_cuda_simulation(scene, "float", 0),
                   late = make_cuda_simulation(scene, "float", 0);
        RunFrame wanted, got;
        for (int f = 0; f < 8; ++f) {
            early->snapshot(wanted);
            late->begin_snapshot(got);
            late->advance();
            std::thread([&] { late->finish_snapshot(got); }).join();
            early->advance();
            EXPECT_TRUE(same_bits(got.positions, wanted.positions)) << f;
            EXPECT_TRUE(same_bits(got.displayed, wanted.displayed)) << f;
            EXPECT_EQ(got.saturation, wanted.saturation) << f;
        }
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
        for (const char* particles : {"groom.particles=24", "groom.particles=100"})
            for (const char* spacing : {"cohesion.spacing=0", "cohesion.spacing=0.01"}) {
                const Scene scene =
                    scene_of(wet_scene, {"groom.grid=[16, 16]", "cohesion.radius=0.012", "cohesion.passes=10",
                                         coherence, particles, spacing});
                const RunFrame wanted = after(scene, 0), got = on_device(scene, 0);
                ASSERT_GT(farthest(wanted.displayed, wanted.positions), 1e-3);
                EXPECT_LT(farthest(got.positions, wanted.positions), 1e-7);
                // Ten passes of sums in another order.
                EXPECT_LT(farthest(got.displayed, wanted.displayed), 1e-5)
                    << coherence << ' ' << particles << ' ' << spacing;
            }
}

// So many that a thread sums up a list and a block moves two strands, the last block one.
TEST_F(Cuda, cohesion_of_many_strands_is_the_cpus) {
    const Scene scene = scene_of(wet_scene, {"groom.grid=[61, 41]", "groom.particles=60",
                                             "cohesion.radius=0.004", "cohesion.passes=10"});
    const RunFrame wanted = after(scene, 0), got = on_device(scene, 0);
    ASSERT_GT(farthest(wanted.displayed, wanted.positions), 1e-4);
    EXPECT_LT(farthest(got.displayed, wanted.displayed), 1e-5);
}

// What acts on all strands at once, or on other steps than the implicit one.
std::vector<Case> coupled(const Scratch& scratch) {
    const std::string grid = "groom.grid=[6, 6]";
    std::string many;
    for (int k = 0; k < 12; ++k)
        many += "[[solid]]\nradius = 0.02\n[[solid.motion.keyframe]]\ntranslation = [" +
                std::to_string(0.03 * k - 0.18) + ", -0.1, -0.05]\n";
    const std::string wet_dry = dry_scene + "[wetness]\n",
                      soft_explicit = dry_scene + "[stiffness]\nwet = 5\n";
    const std::vector<std::string> soft{grid,
                                        "stretch.stiffness=0.05",
                                        "bend.stiffness=5e-4",
                                        "core.stiffness=5e-4",
                                        "integrator.substeps=100",
                                        "groom.particles=12"};
    auto explicit_ones = soft;
    explicit_ones.push_back("integrator.kind='explicit'");
    const Warp twists = [](const Vec3d& x, double time) {
        return rotate(rotation_about({0, 1, 0}, 30 * time * x.y), x) + Vec3d{0.4 * time, 0.3 * time * x.x, 0};
    };
    const std::string twisting = dry_scene +
                                 "[[solid]]\nname = \"skin\"\nshape = \"mesh\"\nspacing = 0.01\n" +
                                 mesh_keyframes(scratch, triangulated(Sphere{0.095}, 32), twists, 24, 6);
    const auto rides = [](std::vector<std::string> set) {
        set.push_back("groom.scalp='skin'");
        return set;
    };
    return {
        {"air",
         dry_scene + "[air]\nsize = 0.6\ngrid = [16, 16, 16]\nwind = [0, 0, 2]\ntwo_way = true\n",
         {grid}},
        {"gusts",
         dry_scene +
             "[air]\nsize = 0.7\ngrid = [40, 33, 24]\nviscosity = 1e-3\n[[air.source]]\nperiod = 0.3\n"
             "center = [0, -0.05, -0.1]\n[[air.source]]\ncenter = [0.1, 0, 0]\nvelocity = [-2, 0, 0]\n",
         {grid}},
        {"flow", wet_scene + "[wetness.flow]\n[[wetness.source]]\nrate = 5\n", {grid}},
        {"flow in fibres", as_fibre(wet_scene) + "[wetness.flow]\n[[wetness.source]]\nrate = 5\n", {grid}},
        {"deforming",
         dry_scene + breathing_sphere(scratch, {0.05, 0.06, 0.07, 0.06}, 0.05, "[0, -0.06, -0.05]", 0.01),
         {grid}},
        {"many solids", dry_scene + many, {grid}},
        {"cohesion in the solve", wet_scene, {grid, "cohesion.strength=500"}},
        {"strand contact", dry_scene + "[motion]\nangle = 40\nperiod = 0.2\n[strand_contact]\n", {grid}},
        {"lin", wet_dry + "[baseline]\nmethod = 'lin'\nradius = 0.05\n", {grid}},
        {"kim", wet_dry + "[baseline]\nmethod = 'kim'\nradius = 0.05\n", {grid}},
        {"boundary particles",
         wet_dry + "[baseline]\nmethod = 'boundary_particles'\n[[solid]]\nradius = 0.1\n",
         {grid}},
        {"iben", dry_scene + "[baseline]\nmethod = 'iben'\n", soft},
        {"lin on iben", wet_dry + "[baseline]\nchain = 'iben'\ncohesion = 'lin'\nradius = 0.05\n", soft},
        {"kim and boundary particles on iben",
         wet_dry + "[baseline]\nchain = 'iben'\ncohesion = 'kim'\nradius = 0.05\nboundary = 'particles'\n" +
             "[[solid]]\nradius = 0.1\n",
         soft},
        {"lin and boundary particles",
         wet_dry + "[baseline]\ncohesion = 'lin'\nradius = 0.05\nboundary = 'particles'\n" +
             "[[solid]]\nradius = 0.1\n",
         {grid}},
        {"riding", twisting, rides({grid})},
        {"riding, at a cut", twisting, rides({grid, "motion.cuts=[2]", "integrator.settle_after_cut=0.1"})},
        {"riding, after a preroll", twisting, rides({grid, "motion.preroll=0.2"})},
        {"riding, in explicit steps", soft_explicit + twisting.substr(dry_scene.size()),
         rides(explicit_ones)},
        {"explicit", soft_explicit + "[[solid]]\nradius = 0.097\nattached = \"head\"\n", explicit_ones},
        {"backward Euler", wet_scene, {grid, "integrator.kind='backward_euler'"}},
    };
}

TEST_F(Cuda, what_acts_on_all_strands_at_once_does_what_it_does_on_the_cpu) {
    const Scratch scratch;
    for (const auto& c : coupled(scratch)) {
        SCOPED_TRACE(c.name);
        const Scene scene = scene_of(c.text, c.set);
        const RunFrame wanted = after(scene, 4, "double"), got = on_device(scene, 4, "double");
        ASSERT_GT(farthest(wanted.positions, scene.groom.rest), 1e-4);
        EXPECT_LT(farthest(got.positions, wanted.positions), 1e-6);
        // Eq 10 sees who is within reach of whom: a pair at its edge, or a last bit of water, moves more.
        EXPECT_LT(farthest(got.seen(), wanted.seen()), 5e-5);
        EXPECT_EQ(got.saturation.size(), wanted.saturation.size());
        ASSERT_EQ(got.energy.size(), wanted.energy.size());
        EXPECT_EQ(got.stage_seconds.size(), wanted.stage_seconds.size());
        for (size_t k = 0; k < got.energy.size(); ++k)
            EXPECT_NEAR(got.energy[k], wanted.energy[k], 1e-3 * std::abs(wanted.energy[k]) + 1e-9) << k;
    }
}

template <class V>
std::vector<V> downloaded(const V* from, size_t count) {
    std::vector<V> out(count);
    check_cuda(cudaMemcpy(out.data(), from, count * sizeof(V), cudaMemcpyDeviceToHost), "download");
    return out;
}

// A sphere that swells and bends, whole or with a hole.
TEST_F(Cuda, level_sets_of_meshes_that_deform_are_the_cpus) {
    for (bool open : {false, true}) {
        SCOPED_TRACE(open);
        Mesh mesh = triangulated(Sphere{0.1}, 64);
        if (open)
            std::erase_if(mesh.triangles,
                          [&](const auto& t) { return mesh.vertices[size_t(t[0])].y < -0.06f; });
        auto at = [&](double time) {
            auto vertices = mesh.vertices;
            for (auto& v : vertices) {
                const Vec3d x = cast<double>(v);
                v = cast<float>(Vec3d{(1 + 2 * time) * x.x, x.y + 0.02 * std::sin(20 * x.z + 40 * time),
                                      x.z + 5 * time * x.x * x.x});
            }
            return vertices;
        };
        const Bounds box{{-0.13, -0.13, -0.13}, {0.13, 0.13, 0.13}};
        const double h = 0.0043, band = 0.01;
        const Stream stream;
        MovingLevelSet cpu(mesh, box, h, band);
        MovingLevelSetDevice gpu(mesh, box, h, band, stream.handle);
        ASSERT_EQ(gpu.nodes(), cpu.nodes());
        std::vector<float> start;
        for (int f = 0; f < 6; ++f) {
            SCOPED_TRACE(f);
            if (f == 4) {
                cpu.hold(at(0.05)), gpu.hold(at(0.05));
            } else if (f > 0) {
                cpu.advance(at(f / 24.0), 1 / 24.0), gpu.advance(at(f / 24.0), 1 / 24.0);
                gpu.launch_advance(stream.handle);
            }
            check_cuda(cudaStreamSynchronize(stream.handle), "rebuilding");
            const size_t n = cpu.nodes();
            const MovingGrid wanted = cpu.grid(0.5), got = gpu.grid(0.5);
            EXPECT_EQ(got.per_second, wanted.per_second);
            const auto phi = downloaded(got.phi, n), before = downloaded(got.phi_before, n);
            const auto velocity = downloaded(got.velocity, n);
            double off = 0, off_before = 0, fastest = 0;
            size_t astray = 0;
            for (size_t k = 0; k < n; ++k) {
                off = std::max(off, std::abs(double(phi[k]) - double(wanted.phi[k])));
                off_before = std::max(off_before, std::abs(double(before[k]) - double(wanted.phi_before[k])));
                fastest = std::max(fastest, double(norm(wanted.velocity[k])));
            }
            for (size_t k = 0; k < n; ++k)
                astray += norm(velocity[k] - wanted.velocity[k]) > float(1e-5 * fastest);
            EXPECT_LT(off, 1e-7);
            EXPECT_LT(off_before, 1e-7);
            EXPECT_EQ(fastest > 0.2, f > 0 && f != 4);
            // As near to two parts of the surface, as far as a rounding tells.
            EXPECT_LE(astray, n / 10000);
            if (f == 0) start = phi;
        }
        const MovingGrid now = cpu.grid(1);
        double moved = 0;
        for (size_t k = 0; k < start.size(); ++k)
            moved = std::max(moved, std::abs(double(start[k]) - double(now.phi[k])));
        EXPECT_GT(moved, 0.01);
    }
}

// Settled, shown, restored, and frames that are not shown.
TEST_F(Cuda, hair_on_solids_that_deform_goes_on_from_wherever_they_are) {
    const Scratch scratch;
    const Scene scene = scene_of(
        wet_scene + breathing_sphere(scratch, {0.05, 0.06, 0.07, 0.06}, 0.05, "[0, -0.06, -0.05]", 0.01),
        {"groom.grid=[6, 6]", "integrator.settle=0.1"});
    const auto cpu = make_simulation(scene, "double"), gpu = make_cuda_simulation(scene, "double", 0);
    RunFrame wanted, got;
    auto expect_the_same = [&](const char* when) {
        cpu->snapshot(wanted), gpu->snapshot(got);
        EXPECT_LT(farthest(got.positions, wanted.positions), 1e-6) << when;
        EXPECT_LT(farthest(got.displayed, wanted.displayed), 1e-5) << when;
        EXPECT_EQ(got.contact, wanted.contact) << when;
        EXPECT_EQ(got.stage_seconds.size(), wanted.stage_seconds.size());
    };
    expect_the_same("settled");
    for (int f = 0; f < 4; ++f) cpu->advance(), gpu->advance(f == 3);
    expect_the_same("after frames");
    ASSERT_GT(std::count(wanted.contact.begin(), wanted.contact.end(), 1), 10);
    const auto stage = std::find(gpu->stages.begin(), gpu->stages.end(), "level set") - gpu->stages.begin();
    EXPECT_GT(got.stage_seconds.at(size_t(stage)), 0);
    for (int f = 0; f < 3; ++f) cpu->advance();
    gpu->restore(cpu->state());
    expect_the_same("restored");
    for (int f = 0; f < 3; ++f) cpu->advance(), gpu->advance();
    expect_the_same("after more frames");
    const RunFrame one = on_device(scene, 6), again = on_device(scene, 6);
    EXPECT_TRUE(same_bits(one.positions, again.positions));
    EXPECT_TRUE(same_bits(one.displayed, again.displayed));
}

// Strands stepped so go where the CPU's go, in double precision to `bound` [m].
void expect_the_cpus(Stepping stepping, double bound) {
    for (const auto& c : cases()) {
        SCOPED_TRACE(c.name);
        const Scene scene = scene_of(c.text, c.set);
        const int frames = c.creases ? 1 : 8;
        const RunFrame wanted = after(scene, frames, "double"),
                       got = Cuda::on_device(scene, frames, "double", stepping);
        EXPECT_LT(farthest(got.positions, wanted.positions), bound);
        EXPECT_EQ(got.contact, wanted.contact);
        EXPECT_LT(strands_astray(Cuda::on_device(scene, 1, "float", stepping).positions,
                                 Cuda::on_device(scene, 1).positions, c.creases ? 1e-4 : 3e-6),
                  9);
    }
}

// A frame as one graph, substep by substep, from a settled state, by the CPU's own pass.
TEST_F(Cuda, strands_on_each_other_do_the_same_however_they_are_run) {
    const Scratch scratch;
    for (const auto& c : coupled(scratch)) {
        SCOPED_TRACE(c.name);
        const Scene scene = scene_of(c.text, c.set);
        if (!scene.strand_contact && !has_pair_forces(scene)) continue;
        const RunFrame one = on_device(scene, 4), again = on_device(scene, 4);
        EXPECT_TRUE(same_bits(one.positions, again.positions));
        EXPECT_EQ(one.energy, again.energy);
        const auto unseen = make_cuda_simulation(scene, "float", 0);
        for (int f = 1; f <= 4; ++f) unseen->advance(f == 4);
        RunFrame last;
        unseen->snapshot(last);
        EXPECT_TRUE(same_bits(one.positions, last.positions));
        EXPECT_EQ(one.energy, last.energy);

        auto set = c.set;
        set.push_back("integrator.settle=0.1");
        const Scene settled = scene_of(c.text, set);
        const auto cpu = make_simulation(settled, "double");
        for (int f = 0; f < 4; ++f) cpu->advance();
        for (Stepping stepping : {Stepping::chosen, Stepping::by_reference}) {
            const auto gpu = make_cuda_simulation(settled, "double", 0, stepping);
            for (int f = 0; f < 4; ++f) gpu->advance();
            RunFrame wanted, got;
            cpu->snapshot(wanted), gpu->snapshot(got);
            ASSERT_GT(farthest(wanted.positions, settled.groom.rest), 1e-4);
            EXPECT_LT(farthest(got.positions, wanted.positions), 1e-6);
            EXPECT_GT(gpu->neighbours_mean(), 0);
            EXPECT_NEAR(gpu->neighbours_mean(), cpu->neighbours_mean(), 0.02 * cpu->neighbours_mean());
        }
    }
}

const std::string flowing = flowing_scene(0, 1e6);
const std::vector<std::string> half_wet{"groom.grid=[6, 6]", "wetness.level=0.5"};

double farthest_saturation(const RunFrame& a, const RunFrame& b) {
    double most = a.saturation.size() == b.saturation.size() ? 0 : INFINITY;
    for (size_t k = 0; most < INFINITY && k < a.saturation.size(); ++k)
        most = std::max(most, std::abs(double(a.saturation[k]) - double(b.saturation[k])));
    return most;
}

double mean_change(const std::vector<float>& a, const std::vector<float>& b) {
    double sum = 0;
    for (size_t k = 0; k < a.size(); ++k) sum += std::abs(double(a[k]) - double(b[k]));
    return sum / double(a.size());
}

TEST_F(Cuda, water_flows_as_on_the_cpu_and_all_that_reads_it_reads_the_same) {
    const std::string unseen = without(flowing, "[cohesion]");
    const std::vector<std::string> printed{"curl.form='printed'", "curl.radius=0.008", "curl.pitch=0.02"};
    for (const auto& c : std::vector<Case>{{"blended curl", flowing, {}},
                                           {"printed curl", flowing, printed},
                                           {"without cohesion", unseen, {}},
                                           {"strand contact", flowing + "[strand_contact]\n", {}}}) {
        SCOPED_TRACE(c.name);
        auto set = half_wet;
        set.insert(set.end(), c.set.begin(), c.set.end());
        const Scene scene = scene_of(c.text, set);
        const auto cpu = make_simulation(scene, "double"), gpu = make_cuda_simulation(scene, "double", 0);
        RunFrame wanted, got, start;
        cpu->snapshot(start);
        for (int f = 0; f < 6; ++f) cpu->advance(), gpu->advance(false);
        cpu->snapshot(wanted), gpu->snapshot(got);
        ASSERT_GT(farthest_saturation(start, wanted), 0.05);
        // Who touches whom follows where strands are seen: floats, and after Eq 10 another order of sums.
        // 1e-5 m there move a saturation by 3e-3 on the CPU itself.
        EXPECT_LT(farthest_saturation(got, wanted), scene.cohesion ? 0.03 : 1e-3);
        EXPECT_LT(mean_change(got.saturation, wanted.saturation), scene.cohesion ? 1e-3 : 1e-4);
        EXPECT_LT(farthest(got.positions, wanted.positions), scene.cohesion ? 2e-4 : 1e-5);
        ASSERT_EQ(got.water.size(), wanted.water.size());
        for (size_t k = 0; k < got.water.size(); ++k)
            EXPECT_NEAR(got.water[k], wanted.water[k], 1e-4 * wanted.water[0]) << k;
        for (size_t k = 0; k < got.energy.size(); ++k)
            EXPECT_NEAR(got.energy[k], wanted.energy[k], 1e-3 * std::abs(wanted.energy[k]) + 1e-9) << k;
        const WaterBalance w = *gpu->water();
        EXPECT_LE(std::abs(w.balance()), 1e-12 * (w.start + w.taken));
        EXPECT_EQ(got.stage_seconds.size(), gpu->stages.size());
    }
}

TEST_F(Cuda, water_that_flows_repeats_to_the_bit_and_goes_on_from_a_state) {
    const Scene scene = scene_of(flowing, half_wet);
    const RunFrame one = on_device(scene, 12), again = on_device(scene, 12);
    EXPECT_EQ(one.saturation, again.saturation);
    EXPECT_EQ(one.water, again.water);
    EXPECT_TRUE(same_bits(one.seen(), again.seen()));
    const auto a = make_cuda_simulation(scene, "double", 0), b = make_cuda_simulation(scene, "double", 0);
    for (int f = 0; f < 4; ++f) a->advance();
    const SimulationState state = a->state();
    EXPECT_EQ(state.saturation.size(), scene.saturation.size());
    b->restore(state);
    RunFrame frames[2];
    b->snapshot(frames[0]);
    EXPECT_EQ(frames[0].saturation, std::vector<float>(state.saturation.begin(), state.saturation.end()));
    for (int f = 0; f < 4; ++f) a->advance(), b->advance();
    a->snapshot(frames[0]), b->snapshot(frames[1]);
    EXPECT_LT(farthest_saturation(frames[0], frames[1]), 1e-6);
    EXPECT_LT(farthest(frames[0].seen(), frames[1].seen()), 1e-6);
    EXPECT_LE(std::abs(b->water()->balance()), 1e-12 * b->water()->start);
}

// The strands of a block share its launches, and no strand another's numbers.
TEST_F(Cuda, steps_by_the_cpus_own_pass_are_the_cpus) { expect_the_cpus(Stepping::by_reference, 1e-7); }

TEST_F(Cuda, a_build_for_parity_has_the_cpus_bits) {
#ifndef WETCURL_PARITY
    GTEST_SKIP() << "SKIP: not a build for parity";
#endif
    const Scratch scratch;
    const auto expect_equal = [](const Case& c, int frames) {
        for (const char* precision : {"float", "double"}) {
            const Scene scene = scene_of(c.text, c.set);
            // The order of sums in Eq 10 and in the air is each device's own; so are bits of what feels them.
            if (scene.flow || scene.air) continue;
            EXPECT_TRUE(same_bits(on_device(scene, frames, precision).positions,
                                  after(scene, frames, precision).positions))
                << c.name << ' ' << precision;
        }
    };
    for (const auto& c : cases()) expect_equal(c, 48);
    // The host computes what acts between strands, launch by launch, and some of these take 100 substeps.
    for (const auto& c : coupled(scratch)) expect_equal(c, 6);
}

TEST_F(Cuda, a_network_in_the_loop_is_asked_as_on_the_cpu) {
    struct HalfOfEq11 : AdhesionPredictor {
        size_t asked = 0;
        void evaluate(const float* inputs, size_t count, float* outputs) override {
            for (size_t k = 0; k < count; ++k) {
                float value, slope;
                Adhesion::shape(inputs[12 * k + 6], value, slope);
                outputs[k] = -0.5f * value;
            }
            asked += count;
        }
    };
    const Scratch scratch;
    for (const std::string& solid : {std::string(), breathing_sphere(scratch, {0.05, 0.06, 0.07, 0.06}, 0.05,
                                                                     "[0, -0.06, -0.05]", 0.01)}) {
        const Scene scene = scene_of(wet_scene + solid, {"groom.grid=[6, 6]"});
        HalfOfEq11 here, there;
        std::vector<AdhesionRecord> records, wanted_records;
        const auto cpu = make_simulation(scene, "double"), gpu = make_cuda_simulation(scene, "double", 0);
        cpu->use_adhesion_predictor(&here), gpu->use_adhesion_predictor(&there);
        cpu->record_adhesion(&wanted_records), gpu->record_adhesion(&records);
        RunFrame wanted, got;
        for (int f = 0; f < 6; ++f) cpu->advance(), gpu->advance();
        cpu->snapshot(wanted), gpu->snapshot(got);
        EXPECT_GT(here.asked, 100u);
        EXPECT_EQ(there.asked, here.asked);
        EXPECT_EQ(records.size(), wanted_records.size());
        EXPECT_LT(farthest(got.positions, wanted.positions), 1e-6);
        EXPECT_GT(farthest(got.positions, after(scene, 6, "double").positions), 1e-6);
    }
}

// Hair on solids of each kind, alone and beside what else acts in a substep.
std::vector<Case> sticky(const Scratch& scratch) {
    const std::string grid = "groom.grid=[6, 6]", odd = "integrator.substeps=5";
    scratch.file("ball.obj", obj_of(triangulated(Sphere{0.1}, 32)));
    const std::string level_set =
        "[[solid]]\nshape = \"mesh\"\nfile = \"" + scratch.path("ball.obj") +
        "\"\nspacing = 0.01\n[[solid.motion.keyframe]]\ntime = 0.08\n[[solid.motion.keyframe]]\ntime = 0.3\n"
        "translation = [0, -0.02, 0.01]\n";
    const std::string alone = wet_scene.substr(0, wet_scene.find("[[solid]]"));
    return {
        {"a ball", wet_scene, {grid, odd}},
        {"even substeps", wet_scene, {grid}},
        {"a level set", alone + level_set, {grid, odd}},
        {"one that deforms",
         alone + breathing_sphere(scratch, {0.09, 0.1, 0.1, 0.09}, 0.06, "[0, 0, 0]", 0.01),
         {grid, odd}},
        {"strands on each other",
         wet_scene + "[strand_contact]\n",
         {grid, "integrator.substeps=3", "cohesion.strength=500"}},
        {"backward Euler", wet_scene, {grid, odd, "integrator.kind='backward_euler'"}},
    };
}

// Within a frame's graph, and never by the host.
TEST_F(Cuda, a_network_of_dense_layers_is_asked_by_the_device) {
#ifdef WETCURL_PARITY
    GTEST_SKIP() << "SKIP: the host asks in a build for parity";
#endif
    const Scratch scratch;
    for (const auto& c : sticky(scratch))
        for (Stepping stepping : {Stepping::chosen, Stepping::by_reference}) {
            SCOPED_TRACE(c.name);
            const Scene scene = scene_of(c.text, c.set);
            DenseAdhesion here(5), there(5);
            const auto cpu = make_simulation(scene, "double"),
                       gpu = make_cuda_simulation(scene, "double", 0, stepping);
            RunFrame wanted, got;
            auto advance = [&](int frames) {
                for (int f = 0; f < frames; ++f) cpu->advance(), gpu->advance(f != 1);
                cpu->snapshot(wanted), gpu->snapshot(got);
                EXPECT_LT(farthest(got.positions, wanted.positions), 1e-6);
                EXPECT_EQ(got.contact, wanted.contact);
            };
            auto use = [&](AdhesionPredictor* on_cpu, AdhesionPredictor* on_gpu) {
                cpu->use_adhesion_predictor(on_cpu), gpu->use_adhesion_predictor(on_gpu);
            };
            auto bytes = [&] {
                size_t sum = 0;
                for (const auto& b : gpu->buffers())
                    if (b.name == "adhesion network") sum += b.bytes;
                return sum;
            };
            advance(3);  // of Eq 11, as a graph
            EXPECT_EQ(bytes(), 0u);
            use(&here, &there);
            EXPECT_GT(bytes(), got.positions.points.size() * sizeof(float));
            advance(5);
            EXPECT_GT(here.asked, 100u);
            EXPECT_GT(here.largest, 0.1f);
            EXPECT_EQ(there.asked, 0u);
            EXPECT_GT(farthest(got.positions, after(scene, 8, "double").positions), 1e-5);
            use(nullptr, nullptr);
            EXPECT_EQ(bytes(), 0u);
            advance(3);
        }
}

// One of them a test: under a sanitizer each takes long.
struct StickyHair : Cuda, ::testing::WithParamInterface<size_t> {};

TEST_P(StickyHair, asks_a_network_of_dense_layers_to_the_bit_and_as_the_host_does) {
    const Scratch scratch;
    const auto cases = sticky(scratch);
    ASSERT_EQ(cases.size(), 6u);  // as many as below
    const Case& c = cases[GetParam()];
    SCOPED_TRACE(c.name);
    const Scene scene = scene_of(c.text, c.set);
    auto run = [&](const std::string& precision, bool gives_layers, bool all_shown, bool recorded) {
        DenseAdhesion model(5, gives_layers);
        std::vector<AdhesionRecord> records;
        const auto gpu = make_cuda_simulation(scene, precision, 0);
        gpu->use_adhesion_predictor(&model);
        if (recorded) gpu->record_adhesion(&records);
        for (int f = 1; f <= 6; ++f) gpu->advance(all_shown || f == 6);
        EXPECT_EQ(records.empty(), !recorded);
        RunFrame frame;
        gpu->snapshot(frame);
        return frame.positions;
    };
    EXPECT_TRUE(same_bits(run("float", true, true, false), run("float", true, true, false)));
    EXPECT_TRUE(same_bits(run("float", true, true, false), run("float", true, false, false)));
    const Strands by_device = run("double", true, true, false);
    EXPECT_LT(farthest(by_device, run("double", false, true, false)), 1e-6);
    EXPECT_LT(farthest(by_device, run("double", true, true, true)), 1e-6);
}

INSTANTIATE_TEST_SUITE_P(Of, StickyHair, ::testing::Range(size_t(0), size_t(6)));

TEST_F(Cuda, a_run_goes_on_from_a_state_of_either_device) {
    const Scene scene = scene_of(wet_scene, {"groom.grid=[6, 6]"});
    const auto cpu = make_simulation(scene, "double"), gpu = make_cuda_simulation(scene, "double", 0);
    for (int f = 0; f < 3; ++f) cpu->advance();
    gpu->restore(cpu->state());
    const auto given = cpu->state(), taken = gpu->state();
    ASSERT_EQ(taken.x.size(), given.x.size());
    for (size_t k = 0; k < given.x.size(); ++k) EXPECT_EQ(norm(taken.x[k] - given.x[k]), 0);
    RunFrame a, b;
    for (int f = 0; f < 3; ++f) cpu->advance(), gpu->advance();
    cpu->snapshot(a), gpu->snapshot(b);
    EXPECT_LT(farthest(b.positions, a.positions), 1e-6);
    EXPECT_LT(farthest(b.displayed, a.displayed), 1e-5);
    expect_error([&] { gpu->count_work(); }, {"--device cpu"});
}

TEST_F(Cuda, several_runs_at_a_time_are_each_as_if_alone) {
    const Scene scene = scene_of(wet_scene, {"groom.grid=[6, 6]"});
    const RunFrame alone = on_device(scene, 12);
    std::vector<RunFrame> together(4);
    std::vector<std::thread> threads;
    for (auto& frame : together) threads.emplace_back([&] { frame = on_device(scene, 12); });
    for (auto& t : threads) t.join();
    for (const auto& frame : together) {
        EXPECT_TRUE(same_bits(frame.positions, alone.positions));
        EXPECT_TRUE(same_bits(frame.displayed, alone.displayed));
    }
}

TEST_F(Cuda, runs_of_other_sizes_beside_it_change_nothing) {
    const Scene large = scene_of(wet_scene, {"groom.grid=[6, 6]", "groom.particles=90"}),
                small = scene_of(wet_scene, {"groom.grid=[6, 6]"});
    const RunFrame alone = on_device(large, 6);
    const auto beside = make_cuda_simulation(large, "float", 0),
               other = make_cuda_simulation(small, "float", 0);
    for (int f = 0; f < 6; ++f) other->advance(), beside->advance();
    RunFrame frame;
    beside->snapshot(frame);
    EXPECT_TRUE(same_bits(frame.displayed, alone.displayed));
}

TEST_F(Cuda, a_device_that_is_not_there_is_said) {
    EXPECT_THROW(make_cuda_simulation(scene_of(dry_scene), "float", 99), Error);
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
