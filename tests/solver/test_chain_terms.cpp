// Terms along a strand against calculus: forces are differenced energies, matrices are differenced forces,
// internal forces move nothing rigidly, damping takes energy. Eq 1-5.
#include <Eigen/Eigenvalues>

#include "tests/solver/one_strand.h"

namespace wetcurl {
namespace {

using namespace testing;
using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double stiffness = 0.7;  // [N/m]

OneStrand curly() { return OneStrand(helix_points(14, 0.1, 0.006, 0.025)); }
OneStrand straight() {
    return OneStrand(straight_points(14, 0.1, normalized(Vec3d{1, 2, -1}, Vec3d{1, 0, 0})));
}

// At rest for every term of this file.
OneStrand resting(OneStrand s, const Core& core) {
    s.rest_on(core);
    return s;
}
Core core_for(const OneStrand& s, double damping = 0) {
    return core_of(stiffness, s.segment(), 0.02, damping);
}

// Particles moved by `share` of a segment at most, frames following.
OneStrand disturbed(OneStrand s, unsigned seed, double share = 0.3) {
    Random random(seed);
    Points to = s.x;
    for (auto& p : to) p += random.vector(share * s.segment());
    s.frame = s.frames_at(to);
    s.x = to;
    return s;
}
OneStrand moving(OneStrand s, unsigned seed) {
    Random random(seed);
    for (auto& v : s.v) v = random.vector(0.5);
    return s;
}

struct Case {
    const char* name;
    OneStrand strand;
};
std::vector<Case> cases() { return {{"curly", curly()}, {"straight", straight()}}; }

template <class Act>
void for_each_term(const OneStrand& s, Act act, double damping = 0) {
    act(stretch_of(stiffness, damping), "stretch");
    act(bend_of(stiffness, damping), "bend");
    act(core_for(s, damping), "core");
    act(twist_of(stiffness, 20), "twist");
}

template <class Matrix>
double size_of(const Eigen::MatrixBase<Matrix>& a) {
    return a.cwiseAbs().maxCoeff();
}

// Central difference of the energy along `direction`, frames carried from those of the strand.
template <class Term>
double energy_slope(const Term& term, OneStrand& s, const Points& direction, double step) {
    auto energy_at = [&](double t) {
        Points x = s.x;
        for (size_t i = 0; i < x.size(); ++i) x[i] += t * direction[i];
        const auto frames = s.frames_at(x);
        return term.energy(s.view_at(x, frames));
    };
    return (energy_at(step) - energy_at(-step)) / (2 * step);
}

// The force differenced: -df/dx, frames carried from those of the strand.
template <class Term>
MatrixXd differenced_force(const Term& term, OneStrand& s, double step) {
    MatrixXd out(3 * s.n, 3 * s.n);
    const VectorXd x0 = stacked(s.x);
    for (long column = 0; column < x0.size(); ++column) {
        auto force_at = [&](double t) {
            VectorXd x = x0;
            x[column] += t;
            const Points at = unstacked(x);
            const auto frames = s.frames_at(at);
            return force_of(term, s.view_at(at, frames));
        };
        out.col(column) = -(force_at(step) - force_at(-step)) / (2 * step);
    }
    return out;
}

Eigen::Vector2d extreme_eigenvalues(const MatrixXd& a) {
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(a, Eigen::EigenvaluesOnly);
    return {solver.eigenvalues().minCoeff(), solver.eigenvalues().maxCoeff()};
}

// Error of the differenced energy for steps of 1e-1 … 1e-8 segments, relative to the force.
template <class Term>
std::vector<double> errors_by_decade(const Term& term, OneStrand& s, unsigned seed) {
    const VectorXd f = force_of(term, s.view());
    EXPECT_GT(size_of(f), 1e-3 * stiffness * s.segment());
    Random random(seed);
    std::vector<double> errors;
    std::vector<Points> directions(8, Points(s.x.size()));
    for (auto& d : directions)
        for (auto& p : d) p = random.vector();
    for (int decade = 1; decade <= 8; ++decade) {
        double worst = 0;
        for (const auto& d : directions) {
            const double slope = energy_slope(term, s, d, std::pow(10.0, -decade) * s.segment());
            worst = std::max(worst, std::abs(slope + f.dot(stacked(d))) / f.norm());
        }
        errors.push_back(worst);
    }
    return errors;
}

TEST(ChainTerms, force_is_the_negative_gradient_of_energy_with_slope_two_before_roundoff) {
    for (auto& [name, rest] : cases())
        for_each_term(rest, [&, &rest = rest, name = name](const auto& term, const char* what) {
            SCOPED_TRACE(std::string(name) + " " + what);
            OneStrand s = disturbed(resting(rest, core_for(rest)), 5);
            const auto errors = errors_by_decade(term, s, 6);
            EXPECT_LT(*std::min_element(errors.begin(), errors.end()), 1e-7);
            // From 1e-2 to 1e-3 segments: far above roundoff, small enough for the leading order.
            EXPECT_NEAR(std::log10(errors[1] / errors[2]), 2, 0.1);
        });
}

TEST(ChainTerms, the_gradient_check_sees_the_printed_bend_and_core_fail) {
    const OneStrand rest = curly();
    OneStrand s = disturbed(resting(rest, core_for(rest)), 5);
    Bend bend = bend_of(stiffness);
    Core core = core_for(rest);
    bend.printed = core.printed = true;
    for (const auto& errors : {errors_by_decade(bend, s, 6), errors_by_decade(core, s, 6)})
        EXPECT_GT(*std::min_element(errors.begin(), errors.end()), 1e-2);
}

TEST(ChainTerms, rest_gives_no_force_and_no_energy) {
    for (auto& [name, rest] : cases())
        for_each_term(rest, [&, &rest = rest](const auto& term, const char* what) {
            SCOPED_TRACE(what);
            OneStrand s = resting(rest, core_for(rest)), bent = disturbed(s, 7);
            EXPECT_GT(size_of(force_of(term, bent.view())), 1e-3 * stiffness * s.segment());
            // Rounding of a segment's own length.
            EXPECT_LT(size_of(force_of(term, s.view())), 1e-14 * stiffness * 0.1);
            EXPECT_LT(term.energy(s.view()), 1e-28 * stiffness * 0.01);
        });
}

TEST(ChainTerms, energy_is_unchanged_and_force_turns_under_rigid_motion) {
    Random random(8);
    for (auto& [name, rest] : cases())
        for_each_term(rest, [&, &rest = rest](const auto& term, const char* what) {
            SCOPED_TRACE(what);
            OneStrand s = disturbed(resting(rest, core_for(rest)), 9), moved = s;
            const Quatd q = random.rotation();
            const Vec3d shift = random.vector(1);
            for (auto& p : moved.x) p = rotate(q, p) + shift;
            for (auto& f : moved.frame) f = q * f;
            const double e = term.energy(s.view());
            EXPECT_GT(e, 1e-4 * stiffness * s.segment() * s.segment());
            EXPECT_NEAR(term.energy(moved.view()), e, 1e-12 * e);
            Points f = unstacked(force_of(term, s.view()));
            for (auto& p : f) p = rotate(q, p);
            EXPECT_LT(size_of(force_of(term, moved.view()) - stacked(f)), 1e-12 * size_of(stacked(f)));
        });
}

// Frames follow the head before they are transported: a yaw of root and strand stores nothing.
TEST(Bend, a_yaw_of_root_and_strand_leaves_the_energy_of_a_curl) {
    OneStrand s = curly();
    const Bend bend = bend_of(stiffness);
    const Quatd yaw = rotation_about({0, 1, 0}, std::numbers::pi / 2);
    Points to = s.x;
    for (auto& p : to) p = rotate(yaw, p);
    std::vector<Quatd> led(s.frame.size());
    transport_frames(s.n, s.frame.data(), yaw, to.data(), led.data());
    const auto left_behind = s.frames_at(to);
    const double unit = stiffness * s.segment() * s.segment();
    EXPECT_LT(bend.energy(s.view_at(to, led)), 1e-28 * unit);
    EXPECT_GT(bend.energy(s.view_at(to, left_behind)), 1e-2 * unit);
}

TEST(ChainTerms, internal_forces_sum_to_zero_and_turn_nothing) {
    for (auto& [name, rest] : cases()) {
        OneStrand s = moving(disturbed(resting(rest, core_for(rest)), 10), 11);
        auto check = [&, name = name](const auto& term, bool twists = false) {
            SCOPED_TRACE(std::string(name) + " " + term.name);
            const Points f = unstacked(force_of(term, s.view()));
            Vec3d sum{0, 0, 0}, torque{0, 0, 0};
            double unit = 0, arm = 0;
            for (size_t i = 0; i < f.size(); ++i) {
                sum += f[i];
                torque += cross(s.x[i], f[i]);
                unit = std::max(unit, norm(f[i]));
                arm = std::max(arm, norm(s.x[i]));
            }
            EXPECT_GT(unit, 1e-3 * stiffness * s.segment());
            EXPECT_LT(norm(sum), 1e-14 * double(s.n) * unit);
            // A curled bend leaves a twist moment where its frames are not at their equilibrium.
            if (twists)
                RecordProperty("curly_bend_torque_residue", std::to_string(norm(torque) / (unit * arm)));
            else
                EXPECT_LT(norm(torque), 1e-12 * unit * arm);
        };
        check(stretch_of(stiffness, 1e-3));
        check(core_for(rest, 1e-3));
        check(bend_of(stiffness), std::string(name) == "curly");
    }
}

// With frames at their equilibrium bend and twist turn nothing but the root's edge, about itself.
TEST(ChainTerms, bend_and_twist_leave_a_moment_about_the_roots_edge_alone) {
    OneStrand s = disturbed(curly(), 10);
    const Bend bend = bend_of(stiffness);
    const Twist twist = twist_of(stiffness);
    auto moment = [&] {
        const Points f = unstacked(force_of(bend, s.view()) + force_of(twist, s.view()));
        Vec3d torque{0, 0, 0};
        for (size_t i = 0; i < f.size(); ++i) torque += cross(s.x[i], f[i]);
        const Vec3d along = frame_direction(s.frame[0]);
        return norm(torque - dot(torque, along) * along);
    };
    const double before = moment();
    std::vector<double> scratch(2 * s.x.size());
    for (int k = 0; k < 2000; ++k)
        relax_twist(bend, twist, s.view(), s.x.data(), 0.0, scratch.data(), s.frame.data());
    EXPECT_GT(before, 1e-4 * stiffness * s.segment() * s.segment());
    EXPECT_LT(moment(), 1e-8 * before);
}

TEST(ChainTerms, matrix_of_stretch_and_bend_at_rest_is_the_differenced_force) {
    for (auto& [name, rest] : cases()) {
        OneStrand s = rest;
        auto check = [&](const auto& term) {
            const MatrixXd k = assembled(term, s.view(), 1).matrix;
            const MatrixXd differenced = differenced_force(term, s, 1e-5 * s.segment());
            EXPECT_GT(size_of(k), 0.5 * stiffness);
            // Central differences at 1e-5 of a segment: 1e-10 of curvature, 1e-11 of rounding.
            EXPECT_LT(size_of(k - differenced), 1e-8 * size_of(k));
            EXPECT_LT(size_of(differenced - differenced.transpose()), 1e-8 * size_of(k));
            const auto range = extreme_eigenvalues(k);
            EXPECT_GT(range[0], -1e-12 * range[1]);
        };
        check(stretch_of(stiffness));
        check(bend_of(stiffness));
    }
}

TEST(ChainTerms, matrices_stay_positive_away_from_rest) {
    for (auto& [name, rest] : cases())
        for_each_term(
            rest,
            [&, &rest = rest](const auto& term, const char* what) {
                SCOPED_TRACE(what);
                OneStrand s = moving(disturbed(resting(rest, core_for(rest)), 12, 1.0), 13);
                const MatrixXd k = assembled(term, s.view(), 0.1).matrix;
                const auto range = extreme_eigenvalues(k);
                EXPECT_GT(range[1], 0);
                EXPECT_GT(range[0], -1e-12 * range[1]);
            },
            0.2);
}

// h C + h² H: the damping's own part, linear in velocity, is exact for stretch and bend and an upper bound
// for the core.
TEST(ChainTerms, the_damping_matrix_is_the_force_by_velocity) {
    OneStrand s = moving(disturbed(curly(), 14), 15);
    s.rest_on(core_for(s));
    auto check = [&](auto term, bool exact) {
        const MatrixXd c = assembled(term, s.view(), 1).matrix;
        const VectorXd v = stacked(s.v), f = force_of(term, s.view());
        OneStrand still = s;
        for (auto& u : still.v) u = {0, 0, 0};
        const VectorXd drag = force_of(term, still.view()) - f;
        EXPECT_GT(drag.norm(), 1e-3 * v.norm());
        if (exact)
            EXPECT_LT((c * v - drag).norm(), 1e-12 * drag.norm());
        else
            EXPECT_GE(v.dot(c * v), v.dot(drag));
    };
    check(stretch_of(0, 0.3), true);
    check(bend_of(0, 0.3), true);
    check(core_of(0, s.segment(), 0.02, 0.3), false);
}

TEST(ChainTerms, damping_never_gives_power) {
    for (unsigned seed = 20; seed < 40; ++seed)
        for (auto& [name, rest] : cases())
            for_each_term(
                rest,
                [&, &rest = rest](const auto& term, const char* what) {
                    SCOPED_TRACE(what);
                    if (std::is_same_v<std::decay_t<decltype(term)>, Twist>) return;  // has no damping
                    OneStrand s = moving(disturbed(resting(rest, core_for(rest)), seed), seed + 100),
                              still = s;
                    for (auto& v : still.v) v = {0, 0, 0};
                    const double power =
                        (force_of(term, s.view()) - force_of(term, still.view())).dot(stacked(s.v));
                    EXPECT_LT(power, -1e-6);
                },
                1e-3);
}

TEST(ChainTerms, a_uniform_velocity_is_not_damped) {
    for (auto& [name, rest] : cases())
        for_each_term(
            rest,
            [&, &rest = rest](const auto& term, const char* what) {
                SCOPED_TRACE(what);
                OneStrand s = disturbed(resting(rest, core_for(rest)), 41), still = s;
                for (auto& v : s.v) v = {3, -2, 1};
                const VectorXd f = force_of(term, still.view());
                EXPECT_GT(size_of(f), 1e-4);
                EXPECT_LT(size_of(force_of(term, s.view()) - f), 1e-14);
            },
            1e-3);
}

TEST(ChainTerms, a_rigid_swing_of_a_straight_strand_at_rest_is_not_damped) {
    const OneStrand rest = straight();
    for_each_term(
        rest,
        [&](const auto& term, const char* what) {
            SCOPED_TRACE(what);
            OneStrand s = resting(rest, core_for(rest));
            for (size_t i = 0; i < s.x.size(); ++i) s.v[i] = cross(Vec3d{1, -3, 2}, s.x[i]);
            EXPECT_GT(norm(s.v.back()), 0.1);
            EXPECT_LT(size_of(force_of(term, s.view())), 1e-14);
        },
        1.0);
}

// With particles 0 and 1 prescribed the filter is a contraction, so k_c D^T D lies above the core's Hessian.
TEST(Core, the_majoriser_lies_above_the_true_hessian_with_the_root_clamped) {
    for (double smoothing : {1.0, 5.0, 20.0}) {
        OneStrand s = curly();
        const Core core = core_of(stiffness, s.segment(), smoothing * s.segment());
        s.rest_on(core);
        for (double disturbance : {0.0, 0.5}) {
            OneStrand at = disturbed(s, 42, disturbance);
            const MatrixXd majoriser = assembled(core, at.view(), 1).matrix;
            MatrixXd hessian = differenced_force(core, at, 1e-5 * at.segment());
            EXPECT_LT(size_of(hessian - hessian.transpose()), 1e-7 * size_of(majoriser));
            hessian = (0.5 * (hessian + hessian.transpose())).eval();
            const long free = majoriser.rows() - 6;
            const auto range = extreme_eigenvalues((majoriser - hessian).bottomRightCorner(free, free));
            EXPECT_GT(range[0], -1e-7 * range[1]) << "alpha / l = " << smoothing;
            if (disturbance > 0) continue;
            const auto own = extreme_eigenvalues(hessian.bottomRightCorner(free, free));
            EXPECT_GT(own[1], 1e-4 * stiffness);
            EXPECT_GT(own[0], -1e-7 * own[1]);
            // The same check fails with the first edge free, as it must: ‖G‖² is 1.6 and more there.
            if (smoothing >= 5) {
                const auto loose = extreme_eigenvalues(majoriser - hessian);
                EXPECT_LT(loose[0], -1e-2 * stiffness);
            }
        }
    }
}

TEST(Stretch, a_segment_of_no_length_takes_the_direction_of_the_one_before) {
    OneStrand s = straight();
    s.x[6] = s.x[5];
    const Assembled a = assembled(stretch_of(stiffness, 0.1), s.view(), 0.01);
    EXPECT_TRUE(a.force.allFinite());
    EXPECT_TRUE(a.matrix.allFinite());
    const Vec3d along = normalized(s.x[5] - s.x[4], Vec3d{1, 0, 0});
    const Points f = unstacked(a.force);
    // Segment 5 pushes particles 5 and 6 apart, segment 6 (twice as long as at rest) draws 6 on.
    EXPECT_NEAR(dot(f[6], along), 2 * stiffness * s.segment(), 1e-12);
}

TEST(Stiffness, is_identity_where_nothing_is_wet_and_no_rate_is_set) {
    OneStrand s = moving(disturbed(curly(), 43), 44);
    const Stiffness none{5.0, 0, 0};
    const Assembled a = assembled(none, s.view(), 0.1);
    EXPECT_TRUE((a.force.array() == 0).all());
    EXPECT_TRUE((a.matrix.array() == 0).all());
    s.saturation.assign(s.saturation.size(), 1.0);
    EXPECT_GT(size_of(force_of(none, s.view())), 0);
}

TEST(Stiffness, brakes_what_moves_against_the_root_at_the_rate_of_its_saturation) {
    OneStrand s = moving(curly(), 45);
    s.root_spin = {0.3, -2, 1};
    s.root_center = {0.1, 0, 0.2};
    s.root_velocity = {1, 2, 3};
    const double sigma = 0.25;
    s.saturation.assign(s.saturation.size(), sigma);
    const Stiffness term{8, 2, 0.5};
    const double rate = 0.5 + sigma * 8 + (1 - sigma) * 2;
    const Points f = unstacked(force_of(term, s.view()));
    for (size_t i = 0; i < f.size(); ++i) {
        const Vec3d rigid = s.root_velocity + cross(s.root_spin, s.x[i] - s.root_center);
        EXPECT_LT(norm(f[i] + rate * s.mass[i] * (s.v[i] - rigid)), 1e-14 * rate * s.mass[i]);
        EXPECT_GT(norm(s.v[i] - rigid), 0.1);
        s.v[i] = rigid;
    }
    EXPECT_LT(size_of(force_of(term, s.view())), 1e-18);
}

TEST(CurlPush, moves_nothing_as_a_whole_turns_with_the_strand_and_is_silent_where_dry) {
    Random random(46);
    OneStrand s = curly();
    const CurlPush push{0.4};
    EXPECT_TRUE((force_of(push, s.view()).array() == 0).all());
    for (auto& p : s.push) p = random.vector(0.01);
    const Points f = unstacked(force_of(push, s.view()));
    Vec3d sum{0, 0, 0};
    for (const auto& p : f) sum += p;
    EXPECT_GT(norm(f[3]), 1e-4);
    EXPECT_LT(norm(sum), 1e-16);
    // The helix's axis is turned to the strand's root-to-tip direction: so is its edge along that axis.
    s.push.assign(s.push.size(), Vec3d{0.01, 0, 0});
    const Points along = unstacked(force_of(push, s.view()));
    const Vec3d axis = normalized(s.x.back() - s.x.front(), Vec3d{1, 0, 0});
    EXPECT_LT(norm(along[0] - 0.004 * axis), 1e-15);
}

}  // namespace
}  // namespace wetcurl
