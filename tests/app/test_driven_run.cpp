// Simulations that a caller drives: where roots are, frames of any length, cuts, water in and out.
#include <gtest/gtest.h>

#include <numeric>
#include <random>

#include "app/engine/driven_run.h"
#include "app/engine/simulated_frames.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

using testing::expect_error;

const std::string hair =
    "fps = 24\n[groom]\ngrid = [5, 3]\nparticles = 14\nlength_noise = 0.1\n[integrator]\nsubsteps = "
    "4\nsettle_after_cut = 0\n"
    "[stretch]\n[bend]\n[core]\n";
const std::string wet = "[wetness]\nlevel = 0.5\n[curl]\n[cohesion]\nradius = 0.03\n";
const std::string ball = "[[solid]]\nname = \"head\"\nradius = 0.095\nattached = \"head\"\n";

Scene scene_of(const std::string& text, const Brought* brought = nullptr) {
    SceneOptions options;
    options.brought = brought;
    return parse_scene(text, "scene.toml", ".", options);
}
DrivenRun run_of(const std::string& text, const DrivenRun::Given& given = {},
                 const Brought* brought = nullptr) {
    return DrivenRun(scene_of(text, brought), given, "cpu", "float", 1);
}

std::vector<Vec3f> simulated(const DrivenRun& run) {
    std::vector<Vec3f> x(size_t(run.strands()) * size_t(run.particles()));
    run.positions(x.data());
    return x;
}
std::vector<Vec3f> velocities(const DrivenRun& run) {
    std::vector<Vec3f> v(size_t(run.strands()) * size_t(run.particles()));
    run.velocities(v.data());
    return v;
}
std::vector<float> saturation(const DrivenRun& run) {
    std::vector<float> sigma(size_t(run.strands()) * size_t(run.particles()));
    run.saturation(sigma.data());
    return sigma;
}
double farthest(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
    double most = 0;
    for (size_t k = 0; k < a.size(); ++k) most = std::max(most, double(norm(a[k] - b[k])));
    return most;
}

Pose pose_at(double time) {
    return {rotation_about({0.6, 0, 0.8}, 0.5 * std::sin(3 * time)),
            {0.1 * time, 0.02 * std::cos(4 * time), 0}};
}

// --- the way between what a caller says -----------------------------------------------------------

TEST(DrivenMotion, it_is_where_it_is_told_and_its_velocity_has_no_jumps) {
    DrivenMotion motion(0, pose_at(0));
    double begin = 0;
    std::vector<double> times, x, turn;
    for (const double span : {0.04, 0.02, 0.07, 0.01, 0.05}) {
        const Pose end = pose_at(begin + span);
        motion.go_to(begin + span, end);
        EXPECT_LT(norm(motion.at(begin + span).translation - end.translation), 1e-15);
        EXPECT_LT(norm(rotate(motion.at(begin + span).rotation, {1, 2, 3}) - rotate(end.rotation, {1, 2, 3})),
                  1e-14);
        for (int k = 1; k <= 200; ++k) {
            const Pose at = motion.at(begin + span * k / 200);
            times.push_back(begin + span * k / 200);
            x.push_back(at.translation.x), turn.push_back(rotate(at.rotation, {0, 1, 0}).x);
        }
        begin += span;
    }
    // A jump in velocity would leave the second difference as large however small the steps are: 0.1 m/s of
    // each span's mean velocity, over one step.
    for (const auto& values : {x, turn}) {
        double most = 0;
        for (size_t k = 1; k + 1 < values.size(); ++k) {
            const double after = (values[k + 1] - values[k]) / (times[k + 1] - times[k]),
                         before = (values[k] - values[k - 1]) / (times[k] - times[k - 1]);
            most = std::max(most, std::abs(after - before));
        }
        EXPECT_LT(most, 0.06);  // of velocities up to 1.5 1/s, in spans of 200 steps
        EXPECT_GT(most, 0);
    }
}

TEST(DrivenMotion, an_even_motion_stays_even) {
    DrivenMotion motion(0, {Quatd::identity(), {0, 0, 0}});
    motion.go_to(0.1, {rotation_about({0, 1, 0}, 0.2), {1, 0, 0}});
    motion.go_to(0.3, {rotation_about({0, 1, 0}, 0.6), {3, 0, 0}});
    motion.go_to(0.4, {rotation_about({0, 1, 0}, 0.8), {4, 0, 0}});
    for (double t = 0.3; t <= 0.4; t += 0.01) {
        EXPECT_NEAR(motion.at(t).translation.x, 10 * t, 1e-12);
        EXPECT_NEAR(2 * std::atan2(motion.at(t).rotation.y, motion.at(t).rotation.w), 2 * t, 1e-12);
    }
}

// --- roots ------------------------------------------------------------------------------------------

TEST(DrivenRun, at_rest_it_is_the_run_to_the_bit) {
    const Scene scene = scene_of(hair + wet + ball);
    const auto simulation = make_simulation(scene, "float");
    DrivenRun run = run_of(hair + wet + ball);
    RunFrame frame;
    for (int f = 0; f < 5; ++f) {
        if (f > 0) simulation->advance(), run.advance(1 / scene.fps);
        simulation->snapshot(frame);
        EXPECT_EQ(farthest(simulated(run), frame.positions.points), 0);
        std::vector<Vec3f> seen(frame.seen().points.size());
        run.displayed(seen.data());
        EXPECT_EQ(farthest(seen, frame.seen().points), 0);
    }
}

TEST(DrivenRun, roots_are_where_the_head_is_put_in_frames_of_any_length) {
    DrivenRun run = run_of(hair + wet + ball);
    const std::vector<Vec3f> rest = simulated(run);
    const size_t n = size_t(run.particles());
    for (const double seconds : {0.04, 0.003, 0.1, 0.017, 0.05, 1e-4}) {
        const Pose pose = pose_at(run.time() + seconds);
        run.move_head(pose);
        run.advance(seconds);
        const auto now = simulated(run);
        for (size_t s = 0; s < size_t(run.strands()); ++s)
            for (size_t i : {0, 1})
                EXPECT_LT(norm(cast<double>(now[s * n + i]) - pose(cast<double>(rest[s * n + i]))), 1e-6);
    }
    EXPECT_NEAR(run.time(), 0.2101, 1e-12);
    // Not moved, it stands still.
    const auto before = simulated(run);
    run.advance(0.04);
    EXPECT_LT(norm(simulated(run)[0] - before[0]), 1e-7f);
    EXPECT_GT(farthest(simulated(run), before), 1e-4);  // strands go on
}

TEST(DrivenRun, each_root_goes_where_it_is_put_and_the_head_is_their_middle) {
    DrivenRun run = run_of(hair, {.roots = true});
    const std::vector<Vec3f> rest = simulated(run);
    const size_t n = size_t(run.particles());
    std::vector<Pose> poses;
    for (int frame = 1; frame <= 4; ++frame) {
        poses.clear();
        for (int s = 0; s < run.strands(); ++s) poses.push_back(pose_at(0.05 * frame + 0.01 * s));
        run.move_roots(poses);
        run.advance(0.03);
    }
    const auto now = simulated(run);
    for (size_t s = 0; s < poses.size(); ++s)
        EXPECT_LT(norm(cast<double>(now[s * n]) - poses[s](cast<double>(rest[s * n]))), 1e-6);
    expect_error([&] { run.move_head({}); }, {"the head goes with the roots"});
}

// --- strands and meshes in memory -------------------------------------------------------------------

Brought brought_strands() {
    Brought out;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> any(-0.05, 0.05);
    for (int s = 0; s < 7; ++s) {
        const Vec3d root{any(random), 0.1, any(random)};
        std::vector<Vec3d> points;
        for (int i = 0; i < 5 + s; ++i) points.push_back(root + Vec3d{0.001 * i * i, 0.02 * i, 0});
        out.strands.push_back(points);
    }
    return out;
}

TEST(DrivenRun, strands_that_are_brought_keep_their_order) {
    const Brought brought = brought_strands();
    DrivenRun run = run_of(hair, {.strands = true}, &brought);
    ASSERT_EQ(run.strands(), 7);
    const auto x = simulated(run);
    const size_t n = size_t(run.particles());
    for (size_t s = 0; s < 7; ++s) {
        EXPECT_LT(norm(cast<double>(x[s * n]) - brought.strands[s].front()), 1e-7);
        EXPECT_LT(norm(cast<double>(x[s * n + n - 1]) - brought.strands[s].back()), 1e-7);
    }
}

TEST(DrivenRun, strands_that_are_none_are_named_by_their_number) {
    Brought brought = brought_strands();
    brought.strands[4] = {{0, 0, 0}, {0, 0, 0}};
    expect_error([&] { scene_of(hair, &brought); }, {"strand 4", "no length"});
    brought.strands[4] = {{0, 0, 0}, {0, NAN, 0}};
    expect_error([&] { scene_of(hair, &brought); }, {"point 1 of strand 4", "not finite"});
    brought = brought_strands();
    brought.meshes["teapot"] = {};
    expect_error([&] { scene_of(hair, &brought); }, {"[[solid]] 'teapot'"});
}

// A box about the origin, its triangles from outside.
Mesh box_mesh(const Vec3f& half) {
    Mesh mesh;
    for (int k = 0; k < 8; ++k)
        mesh.vertices.push_back(
            {k & 1 ? half.x : -half.x, k & 2 ? half.y : -half.y, k & 4 ? half.z : -half.z});
    for (const auto& [a, b, c, d] : std::vector<std::array<int, 4>>{
             {0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}})
        mesh.triangles.push_back({a, b, c}), mesh.triangles.push_back({a, c, d});
    return mesh;
}

TEST(DrivenRun, roots_ride_on_a_mesh_that_is_brought) {
    Brought brought;
    brought.meshes["skull"] = box_mesh({0.1f, 0.1f, 0.1f});
    for (int s = 0; s < 4; ++s)
        brought.strands.push_back({{-0.03 + 0.02 * s, 0.1, 0.01}, {-0.03 + 0.02 * s, 0.25, 0.01}});
    const std::string text =
        "[groom]\nparticles = 12\nscalp = \"skull\"\n[stretch]\n[bend]\n[core]\n[[solid]]\nname = \"skull\"\n"
        "shape = \"mesh\"\nspacing = 0.01\n";
    DrivenRun run = run_of(text, {.strands = true}, &brought);
    const size_t n = size_t(run.particles());
    std::vector<Vec3f> vertices = brought.meshes["skull"].vertices;
    for (int frame = 1; frame <= 10; ++frame) {
        // The box leans over and grows.
        std::vector<Vec3f> now = vertices;
        for (Vec3f& v : now) v = {v.x * (1 + 0.01f * float(frame)) + 0.1f * v.y, v.y, v.z};
        run.move_mesh("skull", now);
        run.advance(frame % 2 ? 0.02 : 0.033);
        const auto x = simulated(run);
        for (size_t s = 0; s < 4; ++s) {
            const Vec3d root = brought.strands[s][0],
                        there{root.x * (1 + 0.01 * frame) + 0.1 * root.y, root.y, root.z};
            EXPECT_LT(norm(cast<double>(x[s * n]) - there), 1e-6);
        }
    }
    // Strands stay outside of the box.
    for (const Vec3f& x : simulated(run))
        EXPECT_TRUE(x.y > 0.098f || std::abs(x.x - 0.1f * x.y) > 0.108f || std::abs(x.z) > 0.098f)
            << x.x << ' ' << x.y;
    expect_error([&] { run.move_mesh("skull", {}); }, {"found 0 vertices, allowed 8"});
    expect_error([&] { run.move_head({}); }, {"the head goes with the roots"});
}

// --- frames of any length -----------------------------------------------------------------------

// The tips [m] of a swing after half a second, in these frames over and over.
std::vector<Vec3d> swing(const std::string& text, const std::vector<double>& frames) {
    const Scene scene = scene_of(text);
    const auto simulation = make_simulation(scene, "double");
    for (size_t k = 0; simulation->time() < 0.5 - 1e-9; ++k)
        simulation->advance_by(std::min(frames[k % frames.size()], 0.5 - simulation->time()));
    RunFrame frame;
    simulation->snapshot(frame);
    std::vector<Vec3d> tips;
    for (int s = 0; s < frame.positions.count; ++s)
        tips.push_back(cast<double>(frame.positions.at(s, frame.positions.particles - 1)));
    return tips;
}
double mean_distance(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b) {
    double sum = 0;
    for (size_t k = 0; k < a.size(); ++k) sum += norm(a[k] - b[k]);
    return sum / double(a.size());
}

TEST(DrivenRun, uneven_frames_err_as_even_ones_do_and_at_the_second_order) {
    const std::string text = "[motion]\naxis = [0, 0, 1]\nangle = 30\nperiod = 0.5\n";
    const auto with = [&](int substeps) {
        std::string scene = hair + text;
        const std::string before = "substeps = 4";
        return scene.replace(scene.find(before), before.size(), "substeps = " + std::to_string(substeps));
    };
    const std::vector<double> uneven{1 / 24.0, 1 / 37.0, 1 / 55.0, 1 / 30.0, 1 / 71.0};
    const auto exact = swing(with(800), {1 / 24.0});
    const double even_40 = mean_distance(swing(with(40), {1 / 24.0}), exact),
                 uneven_40 = mean_distance(swing(with(40), uneven), exact),
                 uneven_80 = mean_distance(swing(with(80), uneven), exact);
    EXPECT_LT(uneven_40, 1.1 * even_40);
    EXPECT_GT(uneven_40 / uneven_80, 3.5);
}

TEST(DrivenRun, frames_of_any_length_give_no_energy_to_stiff_hair) {
    for (const char* stiff :
         {"[stretch]\nstiffness = 1e9\n[bend]\nstiffness = 1e5\n[core]\n", "[stretch]\n[bend]\n[core]\n"}) {
        const Scene scene =
            scene_of("fps = 24\n[groom]\ngrid = [4, 2]\nparticles = 20\n[integrator]\nsubsteps = 5\n" +
                     std::string(stiff));
        const auto simulation = make_simulation(scene, "double");
        const auto sum = [&] {
            const auto kinds = simulation->energy();
            return std::accumulate(kinds.begin(), kinds.end(), 0.0);
        };
        const double first = sum();
        std::mt19937 random(5);
        std::uniform_real_distribution<double> exponent(-3.5, -1);
        double most = first;
        for (int frame = 0; frame < 300; ++frame) {
            simulation->advance_by(std::pow(10, exponent(random)));
            most = std::max(most, sum());
        }
        EXPECT_FALSE(simulation->divergence());
        const double fell = first - sum();
        EXPECT_GT(fell, 0);
        EXPECT_LT(most - first, 1e-3 * fell);
    }
}

TEST(DrivenRun, the_length_of_a_frame_is_refused_where_it_is_none) {
    DrivenRun run = run_of(hair);
    for (const double seconds : {-0.1, 1.5, double(NAN), double(INFINITY)})
        expect_error([&] { run.advance(seconds); }, {"allowed 0 to 1 s"});
    const auto before = simulated(run);
    run.advance(0);
    EXPECT_EQ(farthest(simulated(run), before), 0);
    EXPECT_EQ(run.time(), 0);
}

// --- cuts and water ---------------------------------------------------------------------------------

TEST(DrivenRun, after_a_cut_each_strand_has_its_shape_at_its_root_and_rests) {
    DrivenRun run = run_of(hair + wet + ball);
    for (int frame = 0; frame < 6; ++frame) run.move_head(pose_at(0.04 * frame)), run.advance(0.04);
    const auto before = simulated(run);
    const Pose from = pose_at(0.2), to{rotation_about({0, 0, 1}, 2), {5, 1, -3}};
    run.move_head(to);
    run.cut();
    const auto now = simulated(run);
    for (size_t k = 0; k < now.size(); ++k)
        EXPECT_LT(norm(cast<double>(now[k]) - to(from.inverse(cast<double>(before[k])))), 2e-6);
    for (const Vec3f& v : velocities(run)) EXPECT_EQ(norm(v), 0);
    run.advance(0.04);
    EXPECT_LT(farthest(simulated(run), now), 0.05);  // it falls from rest: g t^2 / 2 is 8 mm
}

TEST(DrivenRun, water_that_is_given_is_there_and_weighs) {
    const std::string flow =
        "[wetness]\nlevel = 0.1\n[wetness.flow]\nconductivity = 0\nexchange = 0\ndrying = 0\nsuction = 0\n";
    DrivenRun run = run_of(hair + flow);
    std::vector<float> sigma = saturation(run);
    for (const float s : sigma) EXPECT_FLOAT_EQ(s, 0.1f);
    for (size_t k = 0; k < sigma.size(); ++k) sigma[k] = float(k % 5) / 4;
    run.wet(sigma.data());
    run.advance(0.04);
    EXPECT_EQ(saturation(run), sigma);
    // As hair that was so wet from the begin.
    sigma.assign(sigma.size(), 0.75f);
    DrivenRun other = run_of(hair +
                             "[wetness]\nlevel = 0.75\n[wetness.flow]\nconductivity = 0\nexchange = "
                             "0\ndrying = 0\nsuction = 0\n"),
              wetted = run_of(hair + flow);
    wetted.wet(sigma.data());
    for (int frame = 0; frame < 8; ++frame) other.advance(0.04), wetted.advance(0.04);
    EXPECT_LT(farthest(simulated(other), simulated(wetted)), 1e-5);
    sigma[3] = 1.5f;
    expect_error([&] { run.wet(sigma.data()); }, {"saturation 1.5 of strand 0, particle 3, allowed 0 to 1"});
    DrivenRun still = run_of(hair + wet);
    sigma[3] = 0.5f;
    expect_error([&] { still.wet(sigma.data()); }, {"[wetness.flow]"});
}

TEST(DrivenRun, cuts_of_the_scene_are_the_callers) {
    expect_error([] { run_of(hair + "[motion]\ncuts = [3]\n"); }, {"found cuts"});
}

}  // namespace
}  // namespace wetcurl
