// The step of one strand: order in dt, energy and noise over stiffnesses, the hanging chain, the cantilever,
// and what keeps the frames. What S1, S2, S5, S6 and S7 of the battery ask, one by one.
#include <cstdio>
#include <Eigen/Cholesky>

#include "tests/solver/one_strand.h"

namespace wetcurl {
namespace {

using namespace testing;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double dt_usual = 1.0 / 240;
const Vec3d gravity{0, -9.81, 0}, no_gravity{0, 0, 0};
constexpr double stiffness_over_mass[] = {1e3, 1e4, 1e5, 1e6, 1e8, 1e10};  // [1/s²]

Points shape_of(bool curly) {
    return curly ? helix_points(50, 0.25, 0.006, 0.025) : straight_points(50, 0.25, {0, -1, 0});
}

// Stretch, bend with its twist, and core of the same stiffness, without damping; `s` is made to rest on them.
ChainTerms undamped(OneStrand& s, double k_over_m) {
    const double k = k_over_m * s.mass[size_t(s.n) / 2];
    const Core core = core_of(k, s.segment());
    s.rest_on(core);
    ChainTerms terms;
    std::get<std::optional<Stretch>>(terms) = stretch_of(k);
    std::get<std::optional<Bend>>(terms) = bend_of(k);
    std::get<std::optional<Twist>>(terms) = twist_of(k);
    std::get<std::optional<Core>>(terms) = core;
    return terms;
}

void add_noise(OneStrand& s, double size, unsigned seed) {
    Random random(seed);
    Points to = s.x;
    for (size_t i = 2; i < to.size(); ++i) to[i] += random.vector(size);
    s.frame = s.frames_at(to);
    s.x = to;
}

double farthest(const Points& a, const Points& b) {
    double most = 0;
    for (size_t i = 0; i < a.size(); ++i) most = std::max(most, norm(a[i] - b[i]));
    return most;
}

// The strand turned about its root, more toward the tip: a large bend.
void sway(OneStrand& s, double angle) {
    Points to = s.x;
    for (size_t i = 2; i < to.size(); ++i) {
        const double share = double(i - 1) / double(to.size() - 2);
        to[i] = to[i - 1] + rotate(rotation_about({0, 0, 1}, angle * share), s.x[i] - s.x[i - 1]);
    }
    s.frame = s.frames_at(to);
    s.x = to;
}

// --- order in dt (S6)

double order_between(double coarse, double fine) { return std::log2(coarse / fine); }

TEST(ImplicitStep, an_oscillator_converges_with_order_two) {
    const double k = 4, amplitude = 0.001, time = 0.05;
    std::vector<double> errors;
    for (int steps : {50, 100, 200, 400}) {
        OneStrand s(straight_points(3, 0.02, {0, -1, 0}));
        s.mass[2] = 1e-3;
        s.x[2].y -= amplitude;
        ChainTerms terms;
        std::get<std::optional<Stretch>>(terms) = stretch_of(k);
        Stepper stepper(terms, s, time / steps, no_gravity);
        for (int i = 0; i < steps; ++i) stepper.step();
        errors.push_back(std::abs(s.x[2].y + 0.02 + amplitude * std::cos(std::sqrt(k / s.mass[2]) * time)));
    }
    EXPECT_GT(errors[0], 1e-4 * amplitude);
    for (size_t i = 1; i < errors.size(); ++i) EXPECT_NEAR(order_between(errors[i - 1], errors[i]), 2, 0.15);
}

Points swung(int steps, double k_over_m, double time) {
    OneStrand s(helix_points(20, 0.1, 0.006, 0.025));
    const ChainTerms terms = undamped(s, k_over_m);
    Stepper stepper(terms, s, time / steps, {3, -9.81, 2});
    for (int i = 0; i < steps; ++i) stepper.step();
    return s.x;
}

TEST(ImplicitStep, a_swinging_curl_converges_with_order_two) {
    constexpr double time = 0.1;
    for (double k_over_m : {1e4, 1e5, 1e6}) {
        const Points exact = swung(51200, k_over_m, time);
        std::vector<double> errors;
        for (int steps : {200, 400, 800, 1600})
            errors.push_back(farthest(swung(steps, k_over_m, time), exact));
        std::printf("swinging curl, k/m = %.0e /s²: errors", k_over_m);
        for (double e : errors) std::printf(" %.2e", e);
        std::printf(" m, orders");
        for (size_t i = 1; i < errors.size(); ++i)
            std::printf(" %.2f", order_between(errors[i - 1], errors[i]));
        std::printf("\n");
        EXPECT_GT(errors.back(), 1e-9);
        // Over three halvings: the fastest springs are hardly resolved at the first.
        EXPECT_GT(order_between(errors[0], errors[3]) / 3, 1.8);
    }
}

// --- energy and noise (S1, S2)

// Energy may not pass what the strand began with; the first step is backward Euler.
struct Undriven {
    double start, most = 0, end, gain = 0;
};
Undriven run_undriven(const ChainTerms& terms, OneStrand& s, const Points& rest, double noise, int steps,
                      double dt) {
    Stepper stepper(terms, s, dt, no_gravity);
    Undriven out{stepper.energy(), 0, 0, 0};
    for (int k = 0; k < steps; ++k) {
        stepper.step();
        out.end = stepper.energy();
        out.most = std::max(out.most, std::isfinite(out.end) ? out.end : unbounded);
        out.gain = std::max(out.gain, farthest(s.x, rest) / noise);
        if (!(out.end < 1e6 * out.start)) break;
    }
    return out;
}

TEST(ImplicitStep, energy_of_an_undriven_strand_never_grows) {
    for (bool curly : {true, false})
        for (double k_over_m : stiffness_over_mass) {
            OneStrand s(shape_of(curly));
            const ChainTerms terms = undamped(s, k_over_m);
            const Points rest = s.x;
            sway(s, 0.03);
            add_noise(s, 0.01 * s.segment(), 3);
            const Undriven run = run_undriven(terms, s, rest, s.segment(), 2000, dt_usual);
            std::printf("undriven %s, k/m = %.0e /s²: E0 %.2e J, most / E0 %.4f, end / E0 %.1e\n",
                        curly ? "curly" : "straight", k_over_m, run.start, run.most / run.start,
                        run.end / run.start);
            EXPECT_GT(run.start, 0);
            EXPECT_LE(run.most, run.start * (1 + 1e-6)) << k_over_m;
        }
}

TEST(ImplicitStep, a_large_sway_of_a_curl_never_gains_energy) {
    for (double k_over_m : stiffness_over_mass) {
        OneStrand s(shape_of(true));
        const ChainTerms terms = undamped(s, k_over_m);
        const Points rest = s.x;
        sway(s, 1.5);
        const Undriven run = run_undriven(terms, s, rest, s.segment(), 2000, dt_usual);
        std::printf("large sway, k/m = %.0e /s²: E0 %.2e J, most / E0 %.4f, end / E0 %.1e\n", k_over_m,
                    run.start, run.most / run.start, run.end / run.start);
        EXPECT_LE(run.most, run.start * (1 + 1e-6)) << k_over_m;
    }
}

TEST(ImplicitStep, noise_at_rest_gains_at_most_a_hundred) {
    for (bool curly : {true, false})
        for (double dt : {dt_usual, dt_usual / 10})
            for (double k_over_m : stiffness_over_mass) {
                OneStrand s(shape_of(curly));
                const ChainTerms terms = undamped(s, k_over_m);
                const Points rest = s.x;
                const double noise = 1e-6 * s.segment();
                add_noise(s, noise, 4);
                const Undriven run = run_undriven(terms, s, rest, noise, 2400, dt);
                std::printf("noise, %s, dt 1/%.0f s, k/m = %.0e /s²: gain %.2f\n",
                            curly ? "curly" : "straight", 1 / dt, k_over_m, run.gain);
                EXPECT_LE(run.gain, 100);
                EXPECT_GT(run.gain, 0.5);
            }
}

// The checks above see the printed forces, which are the gradient of no energy.
TEST(ImplicitStep, the_noise_check_sees_printed_forces_fail) {
    OneStrand s(shape_of(true));
    ChainTerms terms = undamped(s, 1e5);
    std::get<std::optional<Bend>>(terms)->printed = true;
    std::get<std::optional<Core>>(terms)->printed = true;
    const Points rest = s.x;
    const double noise = 1e-6 * s.segment();
    add_noise(s, noise, 4);
    const Undriven run = run_undriven(terms, s, rest, noise, 2400, dt_usual);
    EXPECT_GT(run.gain, 100);
    EXPECT_GT(run.most, run.start);
}

// --- equilibria

TEST(ImplicitStep, a_hanging_chain_extends_each_edge_by_the_weight_below_it) {
    OneStrand s(straight_points(20, 0.2, {0, -1, 0}));
    const double k_s = 0.3;
    ChainTerms terms;
    std::get<std::optional<Stretch>>(terms) = stretch_of(k_s);
    Stepper stepper(terms, s, 0.5, gravity);
    for (int k = 0; k < 400; ++k) stepper.step();
    double below = 0;
    for (int i = s.n - 2; i >= 1; --i) {
        below += s.mass[size_t(i) + 1];
        const double wanted = below * 9.81 / k_s;
        const double extension = norm(s.x[size_t(i) + 1] - s.x[size_t(i)]) - s.rest_length[size_t(i)];
        EXPECT_NEAR(extension, wanted, 1e-9 * 0.2);
        EXPECT_GT(wanted, 1e-6);
    }
}

// Deflection of the tip of a clamped straight strand of m free edges under a small load P across it, over
// P L³ / 3 EI with L = m l and k_b = EI / l³, by Newton's method on the assembled forces.
double cantilever_ratio(int n) {
    const double length = 0.2, flexural = 1e-9;  // [m], [N m²]
    OneStrand s(straight_points(n, length, {0, -1, 0}));
    const double l = s.segment(), free_length = (n - 2) * l;
    const Bend bend = bend_of(flexural / (l * l * l));
    const Stretch stretch = stretch_of(1e4 * bend.k_b);
    const double load = 1e-6 * 3 * flexural / (free_length * free_length);  // a millionth of L
    const long free = 3 * n - 6;
    for (int round = 0; round < 4; ++round) {
        const Assembled b = assembled(bend, s.view(), 1), t = assembled(stretch, s.view(), 1);
        VectorXd f = (b.force + t.force).tail(free);
        f[free - 3] += load;
        const MatrixXd k = (b.matrix + t.matrix).bottomRightCorner(free, free);
        VectorXd dx = VectorXd::Zero(3 * n);
        dx.tail(free) = k.ldlt().solve(f);
        const Points to = unstacked(stacked(s.x) + dx);
        s.frame = s.frames_at(to);
        s.x = to;
    }
    return s.x.back().x / (load * std::pow(free_length, 3) / (3 * flexural));
}

TEST(Cantilever, tip_deflection_is_the_beams_times_the_known_factor_of_the_discretisation) {
    std::printf("cantilever: N, tip / (P L³ / 3EI), (1 + 1/m)(1 + 1/(2m))\n");
    for (int n : {20, 40, 80, 160}) {
        const double m = n - 2, wanted = (1 + 1 / m) * (1 + 0.5 / m), ratio = cantilever_ratio(n);
        std::printf("%4d  %.6f  %.6f\n", n, ratio, wanted);
        // The load's own nonlinearity is 1e-12, the conditioning of the matrix grows with N⁴.
        EXPECT_NEAR(ratio, wanted, 1e-5);
    }
}

// --- the rest of the step

TEST(ImplicitStep, a_strand_at_rest_stays_to_rounding) {
    OneStrand s(shape_of(true));
    const ChainTerms terms = undamped(s, 1e5);
    const Points rest = s.x;
    Stepper stepper(terms, s, dt_usual, no_gravity);
    for (int k = 0; k < 500; ++k) stepper.step();
    EXPECT_LT(farthest(s.x, rest), 1e-14);
}

TEST(ImplicitStep, does_not_depend_on_place_and_turns_with_the_strand) {
    const Quatd q = rotation_about(normalized(Vec3d{1, 2, 3}, Vec3d{1, 0, 0}), 1.1);
    const Vec3d shift{1000, -500, 300};
    auto run = [&](const Quatd& turn, const Vec3d& by) {
        OneStrand s(shape_of(true));
        const ChainTerms terms = undamped(s, 1e5);
        for (auto& p : s.x) p = rotate(turn, p) + by;
        for (auto& f : s.frame) f = turn * f;
        Stepper stepper(terms, s, dt_usual, rotate(turn, gravity));
        for (int k = 0; k < 100; ++k) stepper.step();
        return s.x;
    };
    const Points plain = run(Quatd::identity(), {0, 0, 0}), turned = run(q, {0, 0, 0}),
                 shifted = run(Quatd::identity(), shift);
    EXPECT_GT(farthest(plain, shape_of(true)), 0.01);
    for (size_t i = 0; i < plain.size(); ++i) {
        EXPECT_LT(norm(turned[i] - rotate(q, plain[i])), 1e-10);
        EXPECT_LT(norm(shifted[i] - shift - plain[i]), 1e-8);  // 1e-13 m is one ulp at 1000 m
    }
}

// The root turned by half a turn about y within `steps` steps, then left alone: how far the strand ends from
// its turned rest, its last speed and the energies.
struct Turned {
    double kicked, settled, speed, away;
};
Turned half_a_turn(double k_over_m, int steps) {
    OneStrand s(shape_of(true));
    Points wanted = s.x;
    for (auto& p : wanted) p = rotate(rotation_about({0, 1, 0}, std::numbers::pi), p);
    ChainTerms terms = undamped(s, k_over_m);
    std::get<std::optional<Stiffness>>(terms) = Stiffness{0, 0, 20};
    Stepper stepper(terms, s, 1.0 / 24, no_gravity);
    Turned out{0, 0, 0, 0};
    for (int k = 0; k < steps; ++k) {
        stepper.step(rotation_about({0, 1, 0}, std::numbers::pi / steps));
        out.kicked = std::max(out.kicked, stepper.energy());
    }
    for (int k = 0; k < 2000; ++k) stepper.step();
    for (const auto& v : s.v) out.speed = std::max(out.speed, norm(v));
    out.settled = stepper.energy();
    out.away = farthest(s.x, wanted);
    return out;
}

TEST(ImplicitStep, half_a_turn_of_the_root_in_one_step_stays_finite_and_comes_to_rest) {
    for (double k_over_m : {1e4, 1e7, 1e10}) {
        const Turned t = half_a_turn(k_over_m, 1);
        EXPECT_TRUE(std::isfinite(t.kicked));
        EXPECT_LT(t.settled, 0.05 * t.kicked) << k_over_m;
        EXPECT_LT(t.speed, 1e-3) << k_over_m;
    }
}

TEST(ImplicitStep, half_a_turn_of_the_root_in_half_a_second_brings_the_curl_round) {
    for (double k_over_m : {1e4, 1e7, 1e10}) {
        const Turned t = half_a_turn(k_over_m, 12);
        // Frames keep a little of the twist that the strand went through: a share of its length.
        EXPECT_LT(t.away, 0.1 * 0.25) << k_over_m;
        EXPECT_LT(t.speed, 1e-3) << k_over_m;
    }
}

// Eq 13 as a rate: the velocity at a time does not depend on the step, up to the scheme's order.
TEST(Stiffness, halving_the_step_leaves_the_velocity_up_to_the_order_of_the_scheme) {
    const double rate = 5, time = 0.4;
    std::vector<double> errors;
    for (int steps : {20, 40, 80}) {
        OneStrand s(straight_points(4, 0.1, {0, -1, 0}));
        s.saturation.assign(4, 1.0);
        s.v[3] = {1, 0, 0};
        ChainTerms terms;
        std::get<std::optional<Stiffness>>(terms) = Stiffness{rate, 0, 0};
        Stepper stepper(terms, s, time / steps, no_gravity);
        for (int k = 0; k < steps; ++k) stepper.step();
        errors.push_back(std::abs(s.v[3].x - std::exp(-rate * time)));
    }
    EXPECT_GT(errors[0], 1e-5);
    EXPECT_LT(errors[0], 0.02);
    for (size_t k = 1; k < errors.size(); ++k) EXPECT_NEAR(order_between(errors[k - 1], errors[k]), 2, 0.3);
}

TEST(Frames, transport_keeps_them_orthonormal_and_along_their_edges) {
    OneStrand s(shape_of(true));
    add_noise(s, 0.5 * s.segment(), 9);
    for (int i = 0; i + 1 < s.n; ++i) {
        const Quatd& f = s.frame[size_t(i)];
        const Vec3d along = normalized(s.x[size_t(i) + 1] - s.x[size_t(i)], Vec3d{0, 0, 0});
        EXPECT_NEAR(f.w * f.w + f.x * f.x + f.y * f.y + f.z * f.z, 1, 1e-14);
        EXPECT_LT(norm(rotate(f, Vec3d{1, 0, 0}) - along), 1e-14);
    }
}

TEST(Frames, relaxing_twists_never_raises_the_energy_and_ends_where_no_frame_gains_by_turning) {
    OneStrand s(shape_of(true));
    const Bend bend = bend_of(1);
    const Twist twist = twist_of(1);
    add_noise(s, 0.3 * s.segment(), 21);
    Random random(10);
    for (size_t i = 1; i < s.frame.size(); ++i)
        s.frame[i] = s.frame[i] * rotation_about({1, 0, 0}, 3 * random.number());
    std::vector<double> scratch(2 * s.x.size());
    auto energy = [&](const std::vector<Quatd>& frames) {
        return bend.energy(s.view_at(s.x, frames)) + twist.energy(s.view_at(s.x, frames));
    };
    const double start = energy(s.frame);
    for (int k = 0; k < 400; ++k) {
        const double before = energy(s.frame);
        relax_twist(bend, twist, s.view(), s.x.data(), 0.0, scratch.data(), s.frame.data());
        EXPECT_LE(energy(s.frame), before * (1 + 1e-12));
    }
    EXPECT_LT(energy(s.frame), 0.5 * start);
    for (size_t i = 1; i < s.frame.size(); ++i)
        for (double angle : {-1e-3, 1e-3}) {
            auto turned = s.frame;
            turned[i] = turned[i] * rotation_about({1, 0, 0}, angle);
            EXPECT_GE(energy(turned), energy(s.frame) * (1 - 1e-9)) << i;
        }
}

// A straight strand has nothing but its twist: a linear chain, whose quasi-static solution is one solve.
TEST(Frames, a_twisted_straight_strand_untwists_in_one_step) {
    OneStrand s(straight_points(30, 0.2, {0, -1, 0}));
    const auto rest = s.frame;
    for (size_t i = 1; i < s.frame.size(); ++i)
        s.frame[i] = s.frame[i] * rotation_about({1, 0, 0}, 1e-3 * std::sin(double(i)));
    std::vector<double> scratch(2 * s.x.size());
    relax_twist(bend_of(1), twist_of(1), s.view(), s.x.data(), 0.0, scratch.data(), s.frame.data());
    for (size_t i = 0; i < s.frame.size(); ++i) {
        const double sine = Twist::HalfAngle<double>(rest[i], s.frame[i]).signed_sine();
        EXPECT_LT(std::abs(sine), 1e-8) << i;  // the cube of the angle
    }
}

// In single precision the w of so small a turn is 1: a head that yaws by a degree a second.
TEST(Frames, follow_a_root_that_turns_slowly) {
    const float angle = 1e-4f;
    const Quatf turn{std::cos(angle / 2), 0, std::sin(angle / 2), 0};
    ASSERT_EQ(turn.w, 1.f);
    const Vec3f x[] = {{0, 0, 0}, {0, -0.01f, 0}};
    const Quatf before = root_frame_of(Vec3f{0, -1, 0});
    Quatf after;
    transport_frames(2, &before, turn, x, &after);
    const Vec3f side{0, 0, 1}, moved = rotate(after, side) - rotate(before, side);
    EXPECT_NEAR(norm(moved), angle, 1e-6);
}

TEST(Frames, turning_about_the_first_axis_is_exact_and_stops_at_half_a_turn) {
    const Quatd f = rotation_about({0.6, 0, 0.8}, 1.1);
    for (double angle : {-3.1, -1.0, 0.0, 1e-4, 0.5, 2.0, 3.1, 5.0}) {
        const Quatd wanted =
            f * rotation_about({1, 0, 0}, std::clamp(angle, -std::numbers::pi, std::numbers::pi));
        const Quatd turned = turned_about_itself(f, angle);
        EXPECT_NEAR(
            std::abs(turned.w * wanted.w + turned.x * wanted.x + turned.y * wanted.y + turned.z * wanted.z),
            1, 1e-13);
    }
}

TEST(Limiter, shortens_edges_to_their_allowance_keeps_directions_and_counts) {
    OneStrand s(straight_points(10, 0.09, {0, -1, 0}));
    const Vec3d wanted = s.x[8] + Vec3d{0, -1.1 * 0.01, 0};
    s.x[9].y -= 0.004;
    EXPECT_EQ(limit_strain(s.n, s.rest_length.data(), 0.1, s.x.data()), 1);
    EXPECT_LT(norm(s.x[9] - wanted), 1e-15);
    // An edge in the middle draws all below it along.
    s.x[4] += {0.01, 0, 0};
    EXPECT_GE(limit_strain(s.n, s.rest_length.data(), 0.1, s.x.data()), 2);
    for (size_t i = 0; i + 1 < s.x.size(); ++i)
        EXPECT_LE(norm(s.x[i + 1] - s.x[i]), 1.1 * 0.01 * (1 + 1e-12));
    EXPECT_EQ(limit_strain(s.n, s.rest_length.data(), 0.1001, s.x.data()), 0);
}

}  // namespace
}  // namespace wetcurl
