// The air field against analysis: Poisson's order and residual, divergence, diffusion,
// advection, wind, energy, and the drag on a strand. Stam 1999; Fig 32.
#include <cmath>
#include <numbers>

#include "solver/air/air_field.h"
#include "solver/chain/scene_checks.h"
#include "tests/base/threads.h"
#include "tests/solver/one_strand.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;
using std::numbers::pi;

// --- Poisson's equation

// Values at cell centres of a box [0, sides].
template <class F>
void for_each_cell(const std::array<int, 3>& n, double cell, F f) {
    for (int k = 0; k < n[2]; ++k)
        for (int j = 0; j < n[1]; ++j)
            for (int i = 0; i < n[0]; ++i)
                f(i, j, k, Vec3d{(i + 0.5) * cell, (j + 0.5) * cell, (k + 0.5) * cell});
}

// -lap p = b with p = sin(pi x) sin(2 pi y) sin(3 pi z) e^x, which is zero on the unit cube.
double manufactured(const Vec3d& x) {
    return std::exp(x.x) * std::sin(pi * x.x) * std::sin(2 * pi * x.y) * std::sin(3 * pi * x.z);
}
double manufactured_source(const Vec3d& x) {
    const double of_yz = std::exp(x.x) * std::sin(2 * pi * x.y) * std::sin(3 * pi * x.z);
    return of_yz * ((14 * pi * pi - 1) * std::sin(pi * x.x) - 2 * pi * std::cos(pi * x.x));
}

double poisson_error(int n) {
    PoissonBox box({n, n, n}, 1.0 / n);
    std::vector<double> b;
    for_each_cell({n, n, n}, 1.0 / n,
                  [&](int, int, int, const Vec3d& x) { b.push_back(manufactured_source(x)); });
    box.solve(b);
    double most = 0;
    auto p = b.begin();
    for_each_cell({n, n, n}, 1.0 / n, [&](int, int, int, const Vec3d& x) {
        most = std::max(most, std::abs(*p++ - manufactured(x)));
    });
    return most;
}

TEST(PoissonBox, is_of_second_order_on_a_manufactured_solution) {
    const double e16 = poisson_error(16), e32 = poisson_error(32), e64 = poisson_error(64);
    std::printf("errors %.3g %.3g %.3g, orders %.2f %.2f\n", e16, e32, e64, std::log2(e16 / e32),
                std::log2(e32 / e64));
    EXPECT_LT(e64, 0.01);  // of a solution of size 2
    EXPECT_NEAR(std::log2(e16 / e32), 2, 0.15);
    EXPECT_NEAR(std::log2(e32 / e64), 2, 0.05);
}

// The largest of b + lap p, of the largest b, for a rough b: beyond the surface stands minus the last cell.
double poisson_residual(const std::array<int, 3>& n) {
    const double cell = 0.01;
    PoissonBox box(n, cell);
    Random random(3);
    std::vector<double> b;
    for_each_cell(n, cell, [&](int, int, int, const Vec3d&) { b.push_back(random.vector(1).x); });
    std::vector<double> p = b;
    box.solve(p);
    auto value = [&](int i, int j, int k) {
        const int at[3]{i, j, k};
        int inside[3], sign = 1;
        for (int a = 0; a < 3; ++a) {
            inside[a] = std::clamp(at[a], 0, n[size_t(a)] - 1);
            if (inside[a] != at[a]) sign = -1;
        }
        return sign *
               p[(size_t(inside[2]) * size_t(n[1]) + size_t(inside[1])) * size_t(n[0]) + size_t(inside[0])];
    };
    double most = 0;
    auto right = b.begin();
    for_each_cell(n, cell, [&](int i, int j, int k, const Vec3d&) {
        const double sum = value(i - 1, j, k) + value(i + 1, j, k) + value(i, j - 1, k) + value(i, j + 1, k) +
                           value(i, j, k - 1) + value(i, j, k + 1);
        most = std::max(most, std::abs(*right++ - (6 * value(i, j, k) - sum) / (cell * cell)));
    });
    return most;
}

TEST(PoissonBox, leaves_no_residual_whatever_the_sides) {
    for (const auto& n : std::vector<std::array<int, 3>>{
             {16, 16, 16}, {64, 64, 64}, {64, 32, 96}, {8, 9, 61}, {40, 17, 8}, {13, 8, 24}})
        EXPECT_LT(poisson_residual(n), 1e-12) << n[0] << ' ' << n[1] << ' ' << n[2];
}

// --- the field

Air still_air(int n = 32) {
    Air air{};
    air.size = 0.8, air.viscosity = 0, air.density = 1.2;
    air.grid = {n, n, n};
    return air;
}
template <class F>
void for_each_face(AirField& air, F f) {
    for (int axis = 0; axis < 3; ++axis) {
        const auto n = air.faces(axis);
        for (int k = 0; k < n[2]; ++k)
            for (int j = 0; j < n[1]; ++j)
                for (int i = 0; i < n[0]; ++i) f(air.face(axis, i, j, k), axis, air.place(axis, i, j, k));
    }
}
double component(const Vec3d& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
template <class F>
void set(AirField& air, F velocity) {
    for_each_face(air, [&](double& u, int axis, const Vec3d& x) { u = component(velocity(x), axis); });
}
double fastest(AirField& air) {
    double most = 0;
    for_each_face(air, [&](double u, int, const Vec3d&) { most = std::max(most, std::abs(u)); });
    return most;
}
void stir(AirField& air, unsigned seed, double speed = 1) {
    Random random(seed);
    set(air, [&](const Vec3d&) { return random.vector(speed); });
}
// An eddy about z that dies away towards the surface, with some of each component.
Vec3d eddy(const Vec3d& x) {
    const double s = std::exp(-dot(x, x) / (0.15 * 0.15));
    return (8 * s) * cross(Vec3d{0.3, -0.2, 1}, x);
}

TEST(AirField, a_projection_leaves_no_divergence) {
    for (int n : {16, 33, 64}) {
        AirField air(still_air(n));
        stir(air, 5);
        const double before = air.divergence();
        ASSERT_GT(before, 1);  // [1/s]
        air.project();
        std::printf("%d: divergence %.3g before, %.3g after\n", n, before, air.divergence());
        EXPECT_EQ(air.divergence_before(), before);
        EXPECT_LE(air.divergence(), 1e-12 * before);
    }
}

TEST(AirField, a_projection_is_one_it_is_done_twice_as_once_and_takes_energy) {
    AirField air(still_air());
    stir(air, 7);
    const double stirred = air.energy();
    air.project();
    const double once = air.energy();
    EXPECT_LT(once, stirred);
    EXPECT_GT(once, 0.3 * stirred);  // random air is two thirds without divergence
    AirField again = air;
    again.project();
    double most = 0;
    for (int k = 0; k < 32; ++k)
        for (int j = 0; j < 32; ++j)
            for (int i = 0; i < 33; ++i)
                most = std::max(most, std::abs(again.face(0, i, j, k) - air.face(0, i, j, k)));
    EXPECT_LT(most, 1e-12 * fastest(air));
}

TEST(AirField, a_wave_across_the_box_dies_as_viscosity_says) {
    Air box = still_air();
    box.viscosity = 0.01;
    const double k = 2 * pi / box.size, time = 0.5;
    auto amplitude_error = [&](int steps) {
        AirField air(box);
        // No air crosses the surface in y, so that a wave of whole periods with a crest there stays one.
        set(air, [&](const Vec3d& x) { return Vec3d{std::cos(k * (x.y + box.size / 2)), 0, 0}; });
        const double start = air.face(0, 16, 0, 16);
        for (int s = 0; s < steps; ++s) air.diffuse(time / steps);
        // Of the second difference, whose k is a little less.
        const double k_h = 2 / air.cell() * std::sin(k * air.cell() / 2);
        EXPECT_NEAR(k_h, k, 0.01 * k);
        const double expected = std::exp(-box.viscosity * k_h * k_h * time);
        EXPECT_LT(expected, 0.8);
        EXPECT_NEAR(air.face(0, 16, 5, 3) / air.face(0, 2, 5, 30), 1, 1e-9);
        return air.face(0, 16, 0, 16) / start - expected;
    };
    const double e8 = amplitude_error(8), e16 = amplitude_error(16), e256 = amplitude_error(256);
    std::printf("errors %.3g %.3g %.3g, order %.2f\n", e8, e16, e256, std::log2(e8 / e16));
    EXPECT_LT(std::abs(e256), 2e-4);
    EXPECT_NEAR(std::log2(e8 / e16), 1, 0.05);  // backward Euler
}

TEST(AirField, advection_never_exceeds_what_was_there) {
    AirField air(still_air());
    stir(air, 11, 2);
    double most = fastest(air);
    for (int s = 0; s < 5; ++s) {
        air.advect(1.0 / 24);
        EXPECT_LE(fastest(air), most);
        most = fastest(air);
    }
    EXPECT_GT(most, 0.01);
}

TEST(AirField, advection_carries_a_bump_with_the_wind) {
    Air box = still_air(64);
    box.wind = {2, 0, 0};
    AirField air(box);
    auto bump = [](const Vec3d& x) { return std::exp(-dot(x, x) / (0.08 * 0.08)); };
    set(air, [&](const Vec3d& x) { return Vec3d{2, 0.01 * bump(x + Vec3d{0.1, 0, 0}), 0}; });
    for (int s = 0; s < 4; ++s) air.advect(1.0 / 40);  // 0.2 m
    EXPECT_NEAR(air.at({0.1, 0, 0}).y, 0.01, 0.001);
    EXPECT_NEAR(air.at({-0.1, 0, 0}).y, 0, 0.0001);
}

TEST(AirField, uniform_wind_stays_uniform_in_the_box_and_out_of_it) {
    Air box = still_air();
    box.wind = {1, -0.5, 2};
    box.viscosity = 1e-3;
    AirField air(box);
    for (int s = 0; s < 10; ++s) air.step(1.0 / 24, s / 24.0);
    for (const Vec3d x : {Vec3d{0, 0, 0}, Vec3d{0.399, -0.399, 0.1}, Vec3d{3, 0, 0}})
        EXPECT_LT(norm(air.at(x) - box.wind), 1e-12);
    const double nan = std::nan("");
    EXPECT_LT(norm(air.at({nan, 0, 0}) - box.wind), 1e-12);
}

TEST(AirField, without_a_source_energy_never_grows) {
    for (double viscosity : {0.0, 1e-3}) {
        Air box = still_air();
        box.viscosity = viscosity;
        AirField air(box);
        set(air, eddy);
        air.project();
        double energy = air.energy();
        const double start = energy;
        ASSERT_GT(start, 1e-4);  // [J]
        for (int s = 0; s < 30; ++s) {
            air.step(1.0 / 24, 0);
            EXPECT_LE(air.energy(), energy) << "step " << s;
            energy = air.energy();
        }
        std::printf("viscosity %g: %.3g J, after 30 steps %.3g J\n", viscosity, start, energy);
    }
}

TEST(AirField, a_source_blows_in_its_ball_and_gusts_with_its_period) {
    Air box = still_air();
    AirSource source{};
    source.radius = 0.1, source.period = 2, source.velocity = {3, 0, 0};
    auto share = [&](const Vec3d& x, double time) {
        return source.gust(time) * share_of_ball(source.center, source.radius, x);
    };
    EXPECT_EQ(share({0, 0, 0}, 0), 0);
    EXPECT_NEAR(share({0, 0, 0}, 1), 1, 1e-12);
    EXPECT_NEAR(share({0, 0, 0}, 0.5), 0.5, 1e-12);
    EXPECT_EQ(share({0.11, 0, 0}, 1), 0);
    source.period = 0;
    box.sources = {source};
    AirField air(box);
    for (int s = 1; s <= 24; ++s) air.step(1.0 / 24, s / 24.0);
    EXPECT_GT(air.at({0, 0, 0}).x, 1.5);
    EXPECT_GT(air.at({0.2, 0, 0}).x, 0.5);  // a jet
    EXPECT_LT(air.at({0, 0.25, 0}).x, 0.5 * air.at({0.2, 0, 0}).x);
    EXPECT_LE(air.divergence(), 1e-12 * air.divergence_before());
}

TEST(AirField, hair_brakes_air_towards_its_own_velocity_and_keeps_momentum) {
    Air box = still_air();
    box.wind = {2, 0, 0};
    box.two_way = true;
    const Vec3f velocity{0.5f, 0, 0.25f};
    auto momentum = [&](AirField& air) {
        Vec3d sum{0, 0, 0};
        for_each_face(air, [&](double u, int axis, const Vec3d&) {
            (axis == 0 ? sum.x : axis == 1 ? sum.y : sum.z) += u;
        });
        return (box.density * std::pow(air.cell(), 3)) * sum;
    };
    const double dt = 1.0 / 24;
    for (double drag : {1e-9, 1.0}) {  // [kg/s]
        AirField air(box);
        const Vec3d before = momentum(air);
        air.brake({{{0.01f, 0.02f, -0.03f}, velocity, float(drag)}}, dt);
        const Vec3d u = air.at({0.01, 0.02, -0.03}), got = momentum(air) - before;
        EXPECT_GE(u.x, 0.5);
        EXPECT_LT(u.x, 2);
        EXPECT_GT(u.z, 0);
        EXPECT_LE(u.z, 0.25);
        if (drag < 1e-6) {  // little: the force is that of the undisturbed slip
            EXPECT_NEAR(got.x / (drag * dt * (0.5 - 2)), 1, 1e-3);
            EXPECT_NEAR(got.z / (drag * dt * 0.25), 1, 1e-3);
        } else {
            EXPECT_NEAR(u.x, 0.5, 0.01);  // less where a face lies far from the hair
        }
    }
}

// --- the drag

TEST(AirDrag, is_a_force_per_length_against_the_slip_with_its_own_slope) {
    OneStrand s(helix_points(9, 0.1, 0.006, 0.025));
    Random random(2);
    Points air;
    for (auto& v : s.v) v = random.vector(1), air.push_back(random.vector(2));
    auto c = s.view();
    c.air = air.data();
    const AirDrag term{3e-4};
    const double h = 0.003;
    const Assembled a = assembled(term, c, h);
    double total = 0;
    for (int i = 0; i < s.n; ++i) {
        const double length =
            0.5 * ((i > 0 ? s.rest_length[size_t(i) - 1] : 0) + (i + 1 < s.n ? s.rest_length[size_t(i)] : 0));
        total += length;
        const Vec3d expected = (3e-4 * length) * (air[size_t(i)] - s.v[size_t(i)]);
        ASSERT_GT(norm(expected), 1e-7);
        for (int axis = 0; axis < 3; ++axis) {
            EXPECT_NEAR(a.force[3 * i + axis], component(expected, axis), 1e-18 + 1e-12 * norm(expected));
            EXPECT_NEAR(a.matrix(3 * i + axis, 3 * i + axis), h * 3e-4 * length, 1e-18);
        }
    }
    EXPECT_NEAR(a.matrix.trace(), 3 * h * 3e-4 * total, 1e-15);
    EXPECT_NEAR(a.matrix.sum(), a.matrix.trace(), 1e-15);  // nothing off the diagonal
    EXPECT_EQ(term.energy(c), 0);
    std::fill(air.begin(), air.end(), Vec3d{0, 0, 0});
    EXPECT_LT(force_of(term, c).dot(stacked(s.v)), 0);  // still air takes power
}

// Stretch and air alone: a strand hangs along the sum of its weight and the wind's drag, however long the two
// make it. Soft, since nothing else calms a stiff string without bending.
const std::string windsock = R"(fps = 24
[groom]
grid = [1, 1]
particles = 16
length = 0.15
curl_radius = 0.0
[integrator]
substeps = 4
[stretch]
stiffness = 0.05
[air]
grid = [16, 16, 16]
wind = [0.4, 0, 0]
drag = 1e-4
)";

TEST(AirDrag, a_strand_in_uniform_wind_settles_where_drag_and_weight_balance) {
    for (const char* wind : {"air.wind=[0.4, 0, 0]", "air.wind=[0.8, 0, 0]"}) {
        const Scene scene = scene_of(windsock, {wind});
        const RunFrame frame = after(scene, 200, "double");
        const Vec3f *x = &frame.positions.at(0, 0), d = x[15] - x[1];
        const double angle = std::atan2(d.x, -d.y);
        const double expected = std::atan2(1e-4 * scene.air->wind.x, scene.linear_density * 9.81);
        std::printf("%s: angle %.3f degrees, balance %.3f\n", wind, angle * 180 / pi, expected * 180 / pi);
        EXPECT_GT(expected, 0.5);
        EXPECT_NEAR(angle, expected, 2e-3);
        EXPECT_NEAR(d.z, 0, 1e-4);
    }
}

// --- scenes with air

const std::string blown = dry_scene + R"([air]
grid = [16, 16, 16]
size = 0.6
wind = [0.2, 0, 0]
[[air.source]]
center = [0.1, -0.1, 0]
velocity = [-2, 0.5, 0.3]
period = 0.4
)";

TEST(Air, is_not_there_where_it_is_not_named) {
    auto names = [](const std::string& text) {
        const Scene scene = scene_of(text);
        const auto simulation = make_simulation(scene, "float");
        std::string all;
        for (const auto& b : simulation->buffers()) all += b.name + "\n";
        for (const auto& s : simulation->stages) all += s + "\n";
        for (const auto& p : presence_of(scene).present) all += p + "\n";
        return all;
    };
    EXPECT_EQ(names(dry_scene).find("air"), std::string::npos) << names(dry_scene);
    for (const char* name : {"air velocity\n", "\nair\n", "air drag\n"})
        EXPECT_NE(names(blown).find(name), std::string::npos) << name;
    EXPECT_EQ(names(blown).find("hair in the air"), std::string::npos);
    const auto absent = presence_of(scene_of(dry_scene)).absent;
    EXPECT_NE(std::find(absent.begin(), absent.end(), "air"), absent.end());
    EXPECT_NE(std::find(absent.begin(), absent.end(), "air drag"), absent.end());
}

TEST(Air, gives_the_same_bits_for_one_and_three_threads) {
    const Scene scene = scene_of(blown, {"air.two_way=true", "air.grid=[32, 32, 32]"});
    const auto [one, three] = with_one_and_three_threads([&] { return after(scene, 3); });
    EXPECT_TRUE(same_bits(one.positions, three.positions));
    EXPECT_GT(farthest(one.positions, scene.groom.rest), 1e-3);
}

TEST(Air, keys_that_are_none_are_told_the_nearest) {
    expect_error<Misuse>([&] { scene_of("[groom]\ngrid = [1, 1]\n[air]\nsources = 1\n"); },
                         {"scene.toml:4", "did you mean 'source'"});
    expect_error<Misuse>(
        [&] { scene_of("[groom]\ngrid = [1, 1]\n[air]\n[[air.source]]\ncentre = [0, 0, 0]\n"); },
        {"scene.toml:5", "did you mean 'center'"});
}

}  // namespace
}  // namespace wetcurl
