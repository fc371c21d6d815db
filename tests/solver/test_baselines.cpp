// Compared methods: their kernels against analytic properties, their pairs' symmetry, what they do to wet
// and to dry strands, what they stand in the place of. Akinci 2013; the paper, Fig 41.
#include <algorithm>

#include "solver/chain/scene_checks.h"
#include "solver/pair_forces/pair_forces_coupling.h"
#include "tests/base/threads.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;
using std::string;

constexpr double h = 0.012;

template <class F>
double integral(F f, double a, double b, int steps = 200000) {
    double sum = 0;
    for (int k = 0; k < steps; ++k) sum += f(a + (b - a) * (k + 0.5) / steps);
    return sum * (b - a) / steps;
}
constexpr double pi = std::numbers::pi;

// --- kernels

TEST(CohesionKernel, is_continuous_at_half_its_support_and_zero_from_the_support_on) {
    const double peak = akinci2013::cohesion_kernel(h / 2, h);
    // (h/2)^6 32 / (pi h^9) from both sides: with the h^6/64 outside the factor they would be far apart.
    EXPECT_NEAR(peak * 2 * pi * h * h * h, 1, 1e-12);
    for (double side : {-1.0, 1.0})
        EXPECT_NEAR(akinci2013::cohesion_kernel(h / 2 + side * 1e-9 * h, h) / peak, 1, 1e-7);
    EXPECT_LT(akinci2013::cohesion_kernel(0.999 * h, h), 1e-7 * peak);
    for (double r : {h, 1.001 * h, 3 * h}) EXPECT_EQ(akinci2013::cohesion_kernel(r, h), 0);
}

TEST(CohesionKernel, repels_near_and_attracts_far_and_changes_sign_once) {
    // 2 (q (1 - q))^3 = 1/64
    const double u = std::cbrt(1.0 / 128), zero = h * (1 - std::sqrt(1 - 4 * u)) / 2;
    EXPECT_NEAR(zero / h, 0.2729, 1e-4);
    for (int k = 1; k < 1000; ++k) {
        const double r = h * k / 1000, c = akinci2013::cohesion_kernel(r, h);
        EXPECT_EQ(c > 0, r > zero) << r / h;
    }
    EXPECT_NEAR(akinci2013::cohesion_kernel(0, h) * 2 * pi * h * h * h, -1, 1e-12);
}

TEST(AdhesionKernel, lives_on_the_outer_half_of_its_support_alone) {
    double most = 0, where = 0;
    for (int k = 0; k <= 1200; ++k) {
        const double r = 1.2 * h * k / 1200, a = akinci2013::adhesion_kernel(r, h);
        EXPECT_GE(a, 0);
        if (r <= h / 2 || r >= h) {
            EXPECT_LT(a * h * h * h, 1e-5) << r / h;  // rounding under a fourth root
        }
        if (a > most) most = a, where = r;
    }
    EXPECT_NEAR(where / h, 0.75, 1e-3);
    EXPECT_NEAR(most * h * h * h, 0.007 / std::sqrt(2), 1e-8);
    // The formula as Akinci 2013 prints it.
    const double r = 0.83 * h;
    EXPECT_NEAR(akinci2013::adhesion_kernel(r, h),
                0.007 / std::pow(h, 3.25) * std::pow(-4 * r * r / h + 6 * r - 2 * h, 0.25), 1e-9 * most);
}

TEST(AdhesionKernel, and_cohesion_kernel_scale_with_their_support) {
    // Densities of a length: their integral over the ball does not depend on h.
    auto ball = [](auto kernel, double support) {
        return integral([&](double r) { return 4 * pi * r * r * kernel(r, support); }, 0, support);
    };
    for (auto kernel : {akinci2013::adhesion_kernel, akinci2013::cohesion_kernel}) {
        const double a = ball(kernel, 0.01), b = ball(kernel, 0.05);
        EXPECT_GT(a, 1e-3);
        EXPECT_NEAR(a / b, 1, 1e-9);
    }
}

// --- forces on strands

const string hair = R"(fps = 24
[groom]
grid = [2, 1]
particles = 12
[integrator]
gravity = [0, 0, 0]
[stretch]
[bend]
)";

// Two straight strands down from a height of 0.2 m, `gap` [m] apart.
Scene two_strands(const string& method, double gap, const string& wet = "[wetness]\n",
                  const std::vector<string>& set = {}) {
    Scene scene = scene_of(hair + wet + "[baseline]\nmethod = \"" + method + "\"\n", set);
    for (int s = 0; s < 2; ++s)
        for (int i = 0; i < 12; ++i)
            scene.groom.rest.at(s, i) = {float(s * gap), 0.2f - 0.005f * float(i), 0};
    return scene;
}
// Unequal masses and saturations.
Scene tuft(const string& method) {
    Scene scene = scene_of(hair + "[wetness]\njitter = 0.8\n[baseline]\nmethod = \"" + method + "\"\n",
                           {"groom.grid=[5, 4]"});
    scatter(scene, 7, 0.015);
    return scene;
}
std::vector<Vec3d> forces_on(const Scene& scene) {
    std::vector<Vec3d> force;
    make_pair_forces(scene)->evaluate(positions_of(scene), 0, force);
    return force;
}
double largest(const std::vector<Vec3d>& force) {
    double most = 0;
    for (const auto& f : force) most = std::max(most, norm(f));
    return most;
}

// Differences of the potential against the forces, over the largest force: 1 % is the root shape's slope
// across a step, and the table's.
double off_gradient(Scene scene) {
    std::vector<Vec3d> x = positions_of(scene), force = forces_on(scene);
    const auto forces = make_pair_forces(scene);
    double off = 0;
    for (size_t i = 0; i < x.size(); i += 40) {
        Vec3d difference{0, 0, 0};
        for (double* of : {&x[i].x, &x[i].y, &x[i].z}) {
            double sum = 0;
            for (double side : {1.0, -1.0}) {
                const double step = side * 1e-5;
                *of += step;
                sum -= forces->potential(x, 0) / (2 * step);
                *of -= step;
            }
            (of == &x[i].x ? difference.x : of == &x[i].y ? difference.y : difference.z) = sum;
        }
        off = std::max(off, norm(force[i] - difference));
    }
    EXPECT_GT(largest(force), 1e-12);
    return off / largest(force);
}
TEST(KernelPairForces, are_their_potential_s_gradient_but_for_the_area_s) {
    EXPECT_LT(off_gradient(tuft("lin")), 0.02);
    Scene kim = tuft("kim");
    EXPECT_GT(off_gradient(kim), 0.05);
    std::get<Slot<Kim2016>>(kim.baselines)->gamma_area = 0;
    EXPECT_LT(off_gradient(kim), 0.02);
}

TEST(KernelPairForces, of_a_pair_are_opposite_and_along_their_line) {
    Random random(1);
    const Lin2015 lin{1e4, h};
    const Kim2016 kim{200, 0.2, h};
    double seen = 0;
    for (int k = 0; k < 200; ++k) {
        const Vec3d d = random.vector(h), n = random.vector(1);
        const double a = random.number(1e-8, 5e-8), b = random.number(1e-8, 5e-8), wet = random.number(0, 1);
        const Vec3d f = lin.pair_force(d, a, b, wet), g = kim.pair_force(d, n, a, b, wet);
        seen = std::max({seen, norm(f), norm(g)});
        EXPECT_LE(norm(f + lin.pair_force(-d, b, a, wet)), 1e-12 * norm(f));
        EXPECT_LE(norm(g + kim.pair_force(-d, -n, b, a, wet)), 1e-12 * norm(g));
        EXPECT_LE(norm(cross(f, d)), 1e-12 * norm(f) * norm(d));
        EXPECT_LE(dot(f, d), 0);
    }
    EXPECT_GT(seen, 1e-9);
    EXPECT_EQ(norm(lin.pair_force({0, 0, 0}, 1e-8, 1e-8, 1)), 0);
    EXPECT_EQ(norm(kim.pair_force({0, 0, 0}, {0, 0, 0}, 1e-8, 1e-8, 1)), 0);
}

TEST(KernelPairForces, sum_to_zero_over_the_hair) {
    for (const char* method : {"lin", "kim"}) {
        const auto force = forces_on(tuft(method));
        Vec3d sum{0, 0, 0};
        double total = 0;
        for (const auto& f : force) sum += f, total += norm(f);
        EXPECT_GT(total, 1e-6) << method;
        EXPECT_LT(norm(sum), 1e-12 * total) << method;
    }
}

TEST(KernelPairForces, are_those_of_all_pairs_on_different_strands) {
    const Scene scene = tuft("lin");
    const auto x = positions_of(scene), force = forces_on(scene);
    const auto mass = particle_masses(scene);
    const Lin2015 lin = *scene.baseline<Lin2015>();
    for (size_t i = 0; i < x.size(); ++i) {
        Vec3d sum{0, 0, 0};
        for (size_t j = 0; j < x.size(); ++j)
            if (i / 12 != j / 12)
                sum += lin.pair_force(x[i] - x[j], mass[i], mass[j],
                                      double(scene.saturation[i]) * double(scene.saturation[j]));
        EXPECT_LT(norm(force[i] - sum), 1e-6 * largest(force)) << i;
    }
}

TEST(KernelPairForces, are_the_same_bits_for_one_and_three_threads) {
    for (const char* method : {"lin", "kim"}) {
        const auto [one, three] = with_one_and_three_threads([&] { return forces_on(tuft(method)); });
        EXPECT_GT(largest(one), 0);
        for (size_t k = 0; k < one.size(); ++k)
            EXPECT_TRUE(one[k].x == three[k].x && one[k].y == three[k].y && one[k].z == three[k].z);
    }
}

TEST(KernelPairForces, draw_wet_strands_together_and_leave_dry_and_distant_ones) {
    for (const char* method : {"lin", "kim"}) {
        SCOPED_TRACE(method);
        const double gap = 0.75 * h;
        const auto wet = forces_on(two_strands(method, gap));
        for (size_t i = 0; i < 12; ++i) {
            EXPECT_GT(wet[i].x, 0);
            EXPECT_LT(wet[12 + i].x, 0);
        }
        EXPECT_EQ(largest(forces_on(two_strands(method, gap, "[wetness]\nlevel = 0\n"))), 0);
        EXPECT_EQ(largest(forces_on(two_strands(method, 1.01 * h))), 0);
        // One dry strand beside a wet one.
        Scene half = two_strands(method, gap);
        std::fill(half.saturation.begin() + 12, half.saturation.end(), 0.f);
        EXPECT_EQ(largest(forces_on(half)), 0);
    }
}

TEST(KernelPairForces, of_kim_push_apart_strands_that_are_too_near) {
    const Scene near = two_strands("kim", 0.05 * h, "[wetness]\n", {"baseline.area=0"});
    EXPECT_LT(forces_on(near)[6].x, 0);
}

TEST(KernelPairForces, of_area_draw_in_what_stands_out_of_a_clump) {
    Scene scene =
        scene_of(hair + "[wetness]\n[baseline]\nmethod = \"kim\"\nstrength = 0\n", {"groom.grid=[5, 5]"});
    for (int s = 0; s < 25; ++s)
        for (int i = 0; i < 12; ++i)
            scene.groom.rest.at(s, i) = {0.004f * float(s % 5), -0.004f * float(i), 0.004f * float(s / 5)};
    scene.groom.rest.at(14, 6).x += 0.004f;  // the middle of the side x = 0.016
    EXPECT_LT(forces_on(scene)[14 * 12 + 6].x, 0);
}

TEST(Baselines, wet_strands_meet_in_a_run_and_momentum_is_kept) {
    for (const char* method : {"lin", "kim"}) {
        SCOPED_TRACE(method);
        auto gaps = [&](const string& wet) {
            const Scene scene = two_strands(method, 0.75 * h, wet, {"bend.stiffness=0.002"});
            const Strands p = after(scene, 6, "double").positions;
            double sideways = 0;
            for (int i = 0; i < 12; ++i) sideways += p.at(0, i).x + p.at(1, i).x - 0.75 * h;
            EXPECT_LT(std::abs(sideways), 1e-6);  // what one gains the other loses
            return double(p.at(1, 11).x - p.at(0, 11).x) / (0.75 * h);
        };
        EXPECT_NEAR(gaps("[wetness]\nlevel = 0\n"), 1, 1e-5);
        EXPECT_LT(gaps("[wetness]\n"), 0.95);
    }
}

// --- boundary particles

const string ball = R"([[solid]]
radius = 0.05
)";

TEST(BoundaryParticles, lie_on_the_surface_apart_and_without_holes) {
    const double spacing = 0.004;
    const Shape shape = Sphere{0.05};
    const auto points = sampled_surface(shape, spacing);
    Random random(3);
    for (size_t k = 0; k < points.size(); ++k) {
        // 48 corners a turn, inscribed: a sagitta of 0.1 mm each way.
        EXPECT_LT(std::abs(distance(shape, cast<double>(points[k])).phi), 2.5e-4);
        for (size_t l = 0; l < k; ++l) EXPECT_GE(norm(points[k] - points[l]), 0.7f * 0.999f * float(spacing));
    }
    for (int k = 0; k < 500; ++k) {
        const Vec3d on = 0.05 * normalized(random.vector(1), Vec3d{1, 0, 0});
        double nearest = 1;
        for (const auto& p : points) nearest = std::min(nearest, norm(cast<double>(p) - on));
        EXPECT_LT(nearest, spacing);
    }
    EXPECT_NEAR(double(points.size()), 4 * pi * 0.05 * 0.05 / (spacing * spacing),
                0.5 * double(points.size()));
}

TEST(BoundaryParticles, stand_for_volumes_that_fill_space) {
    const double support = 0.01;
    const auto points = sampled_surface(Plane{}, 0.01);
    std::vector<Vec3f> inner;
    for (const auto& p : points)
        if (std::abs(p.x) < 0.1f && std::abs(p.z) < 0.1f) inner.push_back(p);
    const auto volume = boundary_volumes(inner, support);
    for (size_t k = 0; k < inner.size(); ++k) {
        double sum = 0;
        for (const auto& q : inner) sum += kernel(double(norm(q - inner[k])), support);
        EXPECT_NEAR(volume[k] * sum, 1, 1e-6);
    }
    EXPECT_NEAR(boundary_volumes({{0, 0, 0}}, support)[0] * kernel_at_zero(support), 1, 1e-6);
}

// Adhesion [m/s^2] on a strand along a plane, `height` [m] above it.
std::vector<Vec3d> pull_of_plane(double height, double spacing) {
    Scene scene = scene_of(hair + "[wetness]\n[baseline]\nmethod = \"boundary_particles\"\nspacing = " +
                               std::to_string(spacing) + "\n[[solid]]\nshape = \"plane\"\n",
                           {"groom.grid=[1, 1]", "groom.particles=100"});
    for (int i = 0; i < 100; ++i) scene.groom.rest.at(0, i) = {0.001f * float(i), float(height), 0.0003f};
    auto force = forces_on(scene);
    const auto mass = particle_masses(scene);
    for (size_t i = 0; i < force.size(); ++i) force[i] = (1 / mass[i]) * force[i];
    return force;
}

TEST(BoundaryParticles, draw_hair_to_a_surface_more_smoothly_the_denser_they_lie) {
    double ripple[2];
    int k = 0;
    for (double spacing : {0.006, 0.003}) {
        double mean = 0, along = 0;
        for (const auto& a : pull_of_plane(0.006, spacing)) {
            mean -= a.y / 100;
            along += (a.x * a.x + a.z * a.z) / 100;
        }
        std::printf("boundary particles %g m apart: pull %.1f m/s^2, sideways %.3f of it\n", spacing, mean,
                    std::sqrt(along) / mean);
        EXPECT_GT(mean, 10);
        EXPECT_LT(mean, 300);
        ripple[k++] = std::sqrt(along) / mean;
    }
    EXPECT_LT(ripple[1], ripple[0]);
    EXPECT_GT(ripple[1], 1e-4);  // a level set's is none
    EXPECT_EQ(largest(pull_of_plane(0.0101, 0.004)), 0);
}

TEST(BoundaryParticles, move_with_their_solid) {
    Scene here = two_strands("boundary_particles", 0.1, "[wetness]\n" + ball),
          there = two_strands(
              "boundary_particles", 0.1,
              "[wetness]\n" + ball + "[[solid.motion.keyframe]]\ntranslation = [0.5, 0.1, -0.3]\n");
    Random random(5);
    for (size_t k = 0; k < here.groom.rest.points.size(); ++k) {
        const Vec3d x = random.number(0.052, 0.058) * normalized(random.vector(1), Vec3d{1, 0, 0});
        here.groom.rest.points[k] = cast<float>(x);
        there.groom.rest.points[k] = cast<float>(x + Vec3d{0.5, 0.1, -0.3});
    }
    const auto a = forces_on(here), b = forces_on(there);
    EXPECT_GT(largest(a), 1e-9);
    // Masses of drawn lengths and places in single precision; the kernel's slope has no bound at its ends.
    for (size_t k = 0; k < a.size(); ++k) EXPECT_LT(norm(a[k] - b[k]), 0.05 * largest(a));
    EXPECT_LT(dot(a[0], cast<double>(here.groom.rest.points[0])), 0);
}

// --- Iben 2013

TEST(Iben, is_the_printed_forms_with_explicit_steps_and_a_limit_on_velocities) {
    const string soft = "[stretch]\nstiffness = 0.05\n[bend]\nstiffness = 5e-4\n[core]\nstiffness = 5e-4\n";
    const string groom = "fps = 24\n[groom]\ngrid = [2, 2]\nparticles = 12\n";
    const Scene iben = scene_of(groom + soft + "[baseline]\nmethod = \"iben\"\nvelocity_limit = 1e6\n",
                                {"integrator.substeps=100"});
    const Scene same =
        scene_of(groom + soft, {"integrator.kind='explicit'", "integrator.substeps=100",
                                "bend.form='printed'", "core.form='printed'", "bend.torsion=0"});
    const auto a = after(iben, 4), b = after(same, 4);
    EXPECT_GT(farthest(a.positions, iben.groom.rest), 1e-3);
    EXPECT_TRUE(same_bits(a.positions, b.positions));
    EXPECT_EQ(make_pair_forces(iben), nullptr);
}

TEST(Iben, limits_velocities_from_root_to_tip) {
    const Iben2013 iben{0.5};
    Vec3d x[4]{}, v[4]{{0, 0, 0}, {0.1, 0, 0}, {2.1, 0, 0}, {2.3, 0, 0}};
    iben.limit_velocities(4, 0.01, x, v);
    EXPECT_NEAR(v[2].x, 0.6, 1e-12);
    EXPECT_NEAR(v[3].x, 1.1, 1e-12);  // against the one before as it is now
    EXPECT_NEAR(x[2].x, -0.015, 1e-12);
    EXPECT_EQ(v[1].x, 0.1);
}

// --- together

const string soft_explicit =
    "[stretch]\nstiffness = 0.05\n[bend]\nstiffness = 5e-4\n[core]\nstiffness = 5e-4\n";

// Two strands whose one free particle each is drawn by Lin's force alone, in steps of 1 ms.
Scene pair_on_iben(const std::vector<string>& set = {}) {
    Scene scene = scene_of(
        "fps = 1000\n[groom]\ngrid = [2, 1]\nparticles = 3\n[integrator]\nsubsteps = 1\ngravity = [0, 0, 0]\n"
        "[stretch]\n[wetness]\n[baseline]\nchain = \"iben\"\ncohesion = \"lin\"\n",
        set);
    for (int s = 0; s < 2; ++s)
        for (int i = 0; i < 3; ++i)
            scene.groom.rest.at(s, i) = {float(s * 0.75 * h), 0.2f - 0.005f * float(i), 0};
    return scene;
}
SimulationState after_a_step(const Scene& scene) {
    const auto simulation = make_simulation(scene, "double");
    simulation->advance();
    return simulation->state();
}

TEST(LinOnIben, steps_the_velocity_by_the_force_and_then_the_position_by_the_velocity) {
    const Scene scene = pair_on_iben();
    const auto x = positions_of(scene);
    const auto mass = particle_masses(scene);
    Vec3d force{0, 0, 0};
    for (size_t j = 3; j < 6; ++j)
        force += scene.baseline<Lin2015>()->pair_force(x[2] - x[j], mass[2], mass[j], 1);
    const double dt = 1e-3;
    const Vec3d v = (dt / mass[2]) * force;
    ASSERT_GT(norm(v), 1e-4);
    const SimulationState state = after_a_step(scene);
    // Forces have masses in single precision.
    EXPECT_LT(norm(state.v[2] - v), 1e-6 * norm(v));
    EXPECT_LT(norm(state.x[2] - (x[2] + dt * state.v[2])), 1e-15);
    EXPECT_LT(norm(state.v[2] + state.v[5] - Vec3d{0, 2 * v.y, 0}), 1e-6 * norm(v));  // the mirror's
}

TEST(LinOnIben, is_held_by_both_limits_after_the_step) {
    const Vec3d x = positions_of(pair_on_iben())[2], free = after_a_step(pair_on_iben()).v[2];
    const double half = 0.5 * norm(free);
    const SimulationState slow =
        after_a_step(pair_on_iben({"baseline.velocity_limit=" + std::to_string(half)}));
    EXPECT_NEAR(norm(slow.v[2]) / half, 1, 1e-2);  // so many digits have settings
    EXPECT_LT(norm(slow.x[2] - x - 1e-3 * slow.v[2]), 1e-12);
    // So strong that the edge would be hundreds of times its length.
    const SimulationState strong =
        after_a_step(pair_on_iben({"baseline.velocity_limit=1e9", "baseline.strength=1e10"}));
    EXPECT_NEAR(norm(strong.x[2] - strong.x[1]) / 0.005, 1.1, 1e-5);
    EXPECT_LT(norm(strong.v[2] - 1e3 * (strong.x[2] - x)), 1e-6 * norm(strong.v[2]));
}

TEST(Baselines, on_iben_without_wetness_are_iben_to_the_bit) {
    const string groom = "fps = 24\n[groom]\ngrid = [4, 4]\nparticles = 12\n";
    const std::vector<string> steps{"integrator.substeps=100"};
    const RunFrame iben =
        after(scene_of(groom + soft_explicit + "[baseline]\nmethod = \"iben\"\n", steps), 4);
    for (const string cohesion : {"lin", "kim"}) {
        auto on_iben = [&](const string& level) {
            return after(scene_of(groom + soft_explicit + "[wetness]\nabsorbed = 0\nlevel = " + level +
                                      "\n[baseline]\nchain = \"iben\"\ncohesion = \"" + cohesion +
                                      "\"\nradius = 0.05\n",
                                  steps),
                         4)
                .positions;
        };
        EXPECT_TRUE(same_bits(on_iben("0"), iben.positions)) << cohesion;
        EXPECT_FALSE(same_bits(on_iben("1"), iben.positions)) << cohesion;
    }
}

// Each of the seven ways to name at least one of three parts.
TEST(Baselines, compose_in_every_way) {
    for (int named = 1; named < 8; ++named) {
        const bool chain = named & 1, cohesion = named & 2, boundary = named & 4;
        const string text = "fps = 24\n[groom]\ngrid = [5, 4]\nparticles = 12\n" + soft_explicit +
                            "[wetness]\njitter = 0.8\n" + ball + "[baseline]\n" +
                            (chain ? "chain = \"iben\"\nvelocity_limit = 2\n" : "") +
                            (cohesion ? "cohesion = \"lin\"\nstrength = 1e4\n" : "") +
                            (boundary ? "boundary = \"particles\"\nboundary_strength = 30\n" : "");
        SCOPED_TRACE(text);
        Scene scene = scene_of(text, {"integrator.substeps=100"});
        EXPECT_EQ(scene.baseline<Iben2013>().has_value(), chain);
        EXPECT_EQ(scene.integrator.is_implicit(), !chain);
        EXPECT_EQ(scene.term<Bend>()->printed, chain);
        EXPECT_EQ(cohesion ? scene.baseline<Lin2015>()->beta : 1e4, 1e4);
        EXPECT_EQ(boundary ? scene.baseline<BoundaryParticles2013>()->beta : 30, 30);
        const string forces = string(cohesion ? "Lin 2015" : "") + (cohesion && boundary ? " and " : "") +
                              (boundary ? "boundary particles of Akinci 2013" : "");
        EXPECT_EQ(method_of(scene),
                  "simulated wet, " + (forces.empty()
                                           ? "Iben 2013's chain"
                                           : forces + " on " + (chain ? "Iben 2013's" : "our") + " chain"));
        const auto present = presence_of(scene).present;
        auto has = [&](const char* name) {
            return std::find(present.begin(), present.end(), string("baseline ") + name) != present.end();
        };
        EXPECT_EQ(has("iben"), chain);
        EXPECT_EQ(has("lin"), cohesion);
        EXPECT_EQ(has("boundary_particles"), boundary);
        EXPECT_EQ(make_pair_forces(scene) != nullptr, cohesion || boundary);

        const auto simulation = make_simulation(scene, "double");
        for (int f = 0; f < 3; ++f) simulation->advance();
        EXPECT_FALSE(simulation->divergence());
        EXPECT_EQ(simulation->energy_kinds.back() == "baseline", cohesion || boundary);

        make_dry(scene);
        EXPECT_EQ(scene.names_baseline(), chain);
        EXPECT_EQ(method_of(scene), chain ? "simulated dry, Iben 2013's chain" : "simulated dry");
    }
}

TEST(Baselines, that_act_at_once_sum_their_forces_and_potentials) {
    auto scene = [](const string& baseline) {
        Scene s = scene_of(hair + "[wetness]\njitter = 0.8\n" + ball + "[baseline]\n" + baseline,
                           {"groom.grid=[5, 4]"});
        scatter(s, 7, 0.015);
        for (auto& p : s.groom.rest.points) p.y += 0.045f;
        return s;
    };
    const string lin = "cohesion = \"lin\"\n",
                 boundary = "boundary = \"particles\"\nboundary_spacing = 0.002\n";
    const Scene both = scene(lin + boundary), first = scene(lin), second = scene(boundary);
    const auto sum = forces_on(both), a = forces_on(first), b = forces_on(second);
    ASSERT_GT(largest(a), 1e-9);
    ASSERT_GT(largest(b), 1e-9);
    for (size_t i = 0; i < sum.size(); ++i) EXPECT_EQ(norm(sum[i] - (a[i] + b[i])), 0) << i;
    auto potential = [](const Scene& of) { return make_pair_forces(of)->potential(positions_of(of), 0); };
    EXPECT_LT(potential(first), 0);
    EXPECT_LT(potential(second), 0);
    EXPECT_EQ(potential(both), potential(first) + potential(second));
}

TEST(Baselines, on_iben_s_chain_push_pairs_alike) {
    for (const char* method : {"lin", "kim"}) {
        Scene scene = scene_of(
            hair + "[wetness]\njitter = 0.8\n[baseline]\nchain = \"iben\"\ncohesion = \"" + method + "\"\n",
            {"groom.grid=[5, 4]"});
        scatter(scene, 7, 0.015);
        Vec3d sum{0, 0, 0};
        double total = 0;
        for (const auto& f : forces_on(scene)) sum += f, total += norm(f);
        EXPECT_GT(total, 1e-6) << method;
        EXPECT_LT(norm(sum), 1e-12 * total) << method;
    }
}

// --- as parts of a scene

TEST(Baselines, are_absent_from_scenes_that_name_none) {
    auto has_baseline = [](const std::vector<string>& names) {
        return std::any_of(names.begin(), names.end(),
                           [](const string& n) { return n.starts_with("baseline"); });
    };
    for (const bool named : {false, true}) {
        const Scene scene = named ? two_strands("lin", 0.01) : scene_of(dry_scene);
        const auto simulation = make_simulation(scene, "float");
        std::vector<string> buffers;
        for (const auto& b : simulation->buffers()) buffers.push_back(b.name);
        EXPECT_EQ(has_baseline(buffers), named);
        EXPECT_EQ(has_baseline(simulation->stages), named);
        EXPECT_EQ(has_baseline(presence_of(scene).present), named);
        EXPECT_EQ(has_baseline(presence_of(scene).absent), !named);
    }
}

TEST(Baselines, leave_a_dry_twin_but_for_iben) {
    for (const string name : baseline_names()) {
        Scene scene = name == "iben" ? scene_of(hair + "[baseline]\nmethod = \"iben\"\n")
                                     : two_strands(name, 0.01, "[wetness]\n" + ball);
        make_dry(scene);
        EXPECT_EQ(scene.names_baseline(), name == "iben") << name;
    }
}

TEST(Baselines, refuse_bad_tables_with_file_and_line) {
    const string head = hair + "[wetness]\n[[solid]]\n[baseline]\n";  // the table is line 11
    expect_error<Misuse>([&] { scene_of(head + "method = \"linn\"\n"); },
                         {"scene.toml:12", "did you mean 'lin'"});
    expect_error<Misuse>([&] { scene_of(head); }, {"scene.toml:11", "method"});
    // Another method's row is an unknown key.
    expect_error<Misuse>([&] { scene_of(head + "method = \"lin\"\narea = 1\n"); },
                         {"scene.toml:13", "area", "unknown key", "'kim'", "strength, radius"});
}

TEST(Baselines, refuse_parts_that_do_not_fit) {
    const string head = hair + "[wetness]\n[[solid]]\n[baseline]\n";  // the table is line 11
    auto expect = [&](const string& rows, std::initializer_list<string> said) {
        expect_error<Misuse>([&] { scene_of(head + rows); }, said);
    };
    expect("", {"scene.toml:11", "chain = \"iben\"", "cohesion = \"lin\" | \"kim\"",
                "boundary = \"particles\"", "`method`"});
    expect("velocity_limit = 1\n", {"scene.toml:11", "no compared method"});
    expect("method = \"iben\"\ncohesion = \"lin\"\n", {"scene.toml:12", "beside `cohesion`", "shorthand"});
    expect("chain = \"iban\"\n", {"scene.toml:12", "did you mean 'iben'"});
    expect("cohesion = \"iben\"\n", {"scene.toml:12", "allowed: lin, kim"});
    expect("boundary = \"boundary_particles\"\n", {"scene.toml:12", "allowed: particles"});
    expect("chain = \"iben\"\nradius = 1\n",
           {"scene.toml:13", "unknown key", "'lin'", "allowed: velocity_limit"});
    expect("cohesion = \"lin\"\nboundary = \"particles\"\nspacing = 0.01\n",
           {"scene.toml:14", "unknown key", "calls it boundary_spacing"});
    expect("boundary = \"particles\"\nstrength = 1\n", {"scene.toml:13", "unknown key"});
    expect("cohesion = \"lin\"\nboundary_range = 0.01\n",
           {"scene.toml:13", "unknown key", "'boundary_particles'"});
    expect("chain = \"iben\"\ncohesion = \"kim\"\nstrenth = 1\n", {"scene.toml:14", "strenth", "strength"});
    expect_error<Misuse>([&] { scene_of(hair + "[baseline]\nchain = \"iben\"\ncohesion = \"lin\"\n"); },
                         {"scene.toml:9", "cohesion = \"lin\"", "needs a [wetness]"});
    expect_error<Misuse>(
        [&] {
            scene_of(hair + "[wetness]\n[stiffness]\n[baseline]\nchain = \"iben\"\ncohesion = \"lin\"\n");
        },
        {"scene.toml:10", "chain = \"iben\"", "runs without [stiffness]"});
}

TEST(Baselines, take_the_boundary_s_rows_without_its_name_under_method_alone) {
    const string head = hair + "[wetness]\n[[solid]]\n[baseline]\nmethod = \"boundary_particles\"\n";
    auto of = [](const Scene& scene) { return *scene.baseline<BoundaryParticles2013>(); };
    const auto own = of(scene_of(head + "strength = 20\nrange = 0.02\nspacing = 0.005\n")),
               full = of(scene_of(
                   head + "boundary_strength = 20\nboundary_range = 0.02\nboundary_spacing = 0.005\n"));
    for (const auto& b : {own, full}) {
        EXPECT_EQ(b.beta, 20);
        EXPECT_EQ(b.h, 0.02);
        EXPECT_EQ(b.spacing, 0.005);
    }
    expect_error<Misuse>([&] { scene_of(head + "strength = 20\nboundary_strength = 20\n"); },
                         {"baseline.strength", "unknown key", "boundary_strength"});
}

TEST(Baselines, stand_in_the_place_of_ours_and_say_so) {
    auto expect = [](const string& tables, const string& method, std::initializer_list<string> said) {
        expect_error<Misuse>([&] { scene_of(hair + tables + "[baseline]\nmethod = \"" + method + "\"\n"); },
                             said);
    };
    for (const char* method : {"lin", "kim"}) {
        expect("[wetness]\n[cohesion]\n", method, {"scene.toml:10", "runs without [cohesion]", method});
        expect("", method, {"scene.toml:9", "needs a [wetness]"});
    }
    expect("[wetness]\n", "boundary_particles", {"scene.toml:10", "[[solid]]"});
    expect("[wetness]\n[adhesion]\n[[solid]]\n", "boundary_particles",
           {"scene.toml:10", "runs without [adhesion]"});
    expect("[stiffness]\n", "iben", {"scene.toml:9", "runs without [stiffness]"});
    expect("[core]\nform = \"variational\"\n", "iben", {"scene.toml:10", "printed"});
    expect_error<Misuse>(
        [&] {
            scene_of(
                "[groom]\n[integrator]\nkind = \"implicit\"\n[stretch]\n[baseline]\nmethod = \"iben\"\n");
        },
        {"scene.toml:3", "explicitly"});
}

TEST(Baselines, keep_a_run_that_blew_up_from_crashing) {
    const Scene scene =
        two_strands("lin", 0.008, "[wetness]\n",
                    {"stretch.stiffness=1e4", "integrator.kind='explicit'", "integrator.limiter=0"});
    const auto simulation = make_simulation(scene, "float");
    for (int f = 0; f < 5; ++f) simulation->advance();
    EXPECT_TRUE(simulation->divergence());
}

}  // namespace
}  // namespace wetcurl
