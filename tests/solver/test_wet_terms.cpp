// Curl, adhesion, contact and wetness against geometry. Eq 6-9, 11, 12; Fig 27.
#include <Eigen/SVD>

#include "base/geometry/shapes.h"
#include "solver/grooms/procedural.h"
#include "solver/solids/contact.h"
#include "solver/terms/wetness.h"
#include "tests/solver/one_strand.h"

namespace wetcurl {
namespace {

using namespace testing;
using std::numbers::pi;

// --- the helix (Eq 6)

TEST(Helix, its_angle_keeps_the_length_of_a_segment) {
    for (double r : {0.002, 0.006, 0.02})
        for (double pitch : {0.005, 0.025, 0.2})
            for (double l : {0.0005, 0.002, 0.005}) {
                const double p = pitch / (2 * pi), omega = helix_angle(r, p, l);
                EXPECT_GT(omega, 0);
                if (std::hypot(2 * r, p * pi) < l)
                    EXPECT_EQ(omega, pi);  // half a turn is the most that a polyline shows
                else
                    EXPECT_NEAR(std::hypot(2 * r * std::sin(omega / 2), p * omega), l, 1e-12 * l);
            }
}

TEST(Helix, without_radius_it_is_straight_and_without_pitch_a_circle_both_finite) {
    EXPECT_NEAR(helix_angle(0, 0.004, 0.005), 0.005 / 0.004, 1e-12);
    EXPECT_NEAR(helix_angle(0.006, 0, 0.005), 2 * std::asin(0.005 / 0.012), 1e-12);
    EXPECT_TRUE(std::isfinite(helix_angle(0, 0, 0.005)));
}

// --- the rotation (Eq 7, 8)

TEST(HelixRotation, turns_h_to_p_in_so3_and_with_the_world) {
    Random random(1);
    for (int k = 0; k < 200; ++k) {
        const Vec3d h = random.direction(), p = random.direction(), axis = random.direction();
        const Mat3<double> m = helix_rotation(h, p, axis);
        const Eigen::Matrix3d r = eigen(m);
        EXPECT_LT((r * r.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12);
        EXPECT_NEAR(r.determinant(), 1, 1e-12);
        EXPECT_LT(norm(m * h - p), 1e-12);
        const Quatd q = random.rotation();
        const Mat3<double> turned = helix_rotation(rotate(q, h), rotate(q, p), rotate(q, axis));
        EXPECT_LT(norm(turned * rotate(q, axis) - rotate(q, m * axis)), 1e-11);
    }
}

TEST(HelixRotation, of_a_vector_to_itself_is_the_identity) {
    const Vec3d h = normalized(Vec3d{1, -2, 0.5}, Vec3d{1, 0, 0});
    EXPECT_LT((eigen(helix_rotation(h, h, {0, 0, 1})) - Eigen::Matrix3d::Identity()).norm(), 1e-15);
}

TEST(HelixRotation, of_opposed_vectors_is_a_half_turn_about_the_axis_that_is_carried_on) {
    Random random(2);
    for (int k = 0; k < 50; ++k) {
        const Vec3d h = random.direction(), axis = random.direction();
        const Mat3<double> m = helix_rotation(h, -h, axis);
        const Vec3d u = normalized(axis - dot(axis, h) * h, Vec3d{0, 0, 0});
        EXPECT_LT(norm(m * h + h), 1e-12);
        EXPECT_LT(norm(m * u - u), 1e-12);
        EXPECT_NEAR(eigen(m).determinant(), 1, 1e-12);
    }
    const Vec3d h{0, 1, 0};
    EXPECT_TRUE(eigen(helix_rotation(h, -h, h)).allFinite());  // even an axis along h
}

// --- the wet shape (Eq 9)

// Unit axis of a helix of even segments: what differences of its edges are perpendicular to. Edge 0 is left
// out, since the root's edge is prescribed.
Eigen::Vector3d helix_axis(const Points& p) {
    Eigen::MatrixXd bends(long(p.size()) - 3, 3);
    for (size_t i = 1; i + 2 < p.size(); ++i) {
        const Vec3d d = p[i + 2] - 2.0 * p[i + 1] + p[i];
        bends.row(long(i) - 1) << d.x, d.y, d.z;
    }
    return Eigen::JacobiSVD<Eigen::MatrixXd>(bends, Eigen::ComputeThinV).matrixV().col(2);
}
double axial_extent(const Points& p) {
    const Eigen::Vector3d a = helix_axis(p);
    const Vec3d d = p.back() - p[1];
    return std::abs(a[0] * d.x + a[1] * d.y + a[2] * d.z);
}
Points shape_of(const std::vector<Vec3d>& tbar) {
    return shape_from_intrinsic(tbar, {0, 0, 0}, Quatd::identity());
}

Points dry_helix(int n = 50) { return helix_points(n, 0.25, 0.006, 0.025); }
Curl to_contraction(double contraction) { return {1, contraction, 16, std::nullopt, std::nullopt}; }
Curl to_helix(double radius, double pitch) { return {1, 0.7, 2, radius, pitch}; }
std::vector<float> wet(size_t n, float sigma = 1) { return std::vector<float>(n, sigma); }

TEST(Intrinsic, shape_and_back_gives_the_points) {
    Random random(3);
    Points p = dry_helix();
    for (auto& x : p) x += random.vector(0.001);
    const auto tbar = intrinsic_shape(p);
    const Points back =
        shape_from_intrinsic(tbar, p[0], root_frame_of(normalized(p[1] - p[0], Vec3d{1, 0, 0})));
    for (size_t i = 0; i < p.size(); ++i) EXPECT_LT(norm(back[i] - p[i]), 1e-14);
}

TEST(Curled, leaves_every_bit_where_hair_is_dry_or_the_weight_is_zero) {
    const auto tbar = intrinsic_shape(dry_helix());
    auto same = [&](const std::vector<Vec3d>& a, size_t i) {
        return a[i].x == tbar[i].x && a[i].y == tbar[i].y && a[i].z == tbar[i].z;
    };
    for (bool named : {true, false}) {
        Curl curl = named ? to_helix(0.008, 0.02) : to_contraction(0.7);
        const auto dry = curled(curl, tbar, wet(50, 0).data());
        auto half = wet(50, 0);
        std::fill(half.begin() + 25, half.end(), 1.f);
        const auto half_wet = curled(curl, tbar, half.data());
        for (size_t i = 0; i < tbar.size(); ++i) EXPECT_TRUE(same(dry, i));
        for (size_t i = 0; i < 25; ++i) EXPECT_TRUE(same(half_wet, i));
        for (size_t i = 25; i < tbar.size(); ++i) EXPECT_FALSE(same(half_wet, i));
        curl.w_h = 0;
        for (size_t i = 0; i < tbar.size(); ++i) EXPECT_TRUE(same(curled(curl, tbar, wet(50).data()), i));
    }
}

TEST(Curled, keeps_the_lengths_of_segments) {
    const auto tbar = intrinsic_shape(dry_helix());
    for (float sigma : {0.3f, 1.f}) {
        const auto out = curled(to_contraction(0.6), tbar, wet(50, sigma).data());
        for (size_t i = 0; i < tbar.size(); ++i) EXPECT_NEAR(norm(out[i]), norm(tbar[i]), 1e-15);
    }
}

TEST(Curled, to_a_named_helix_has_its_axial_extent) {
    const auto tbar = intrinsic_shape(dry_helix());
    for (double radius : {0.004, 0.008})
        for (double pitch : {0.015, 0.03}) {
            const Curl curl = to_helix(radius, pitch);
            const double l = norm(tbar[1]), p = pitch / (2 * pi), arc = l * double(tbar.size() - 1);
            const double wanted = p * helix_angle(radius, p, l) / l * arc;
            EXPECT_GT(std::abs(wanted / axial_extent(dry_helix()) - 1), 0.05);
            EXPECT_NEAR(axial_extent(shape_of(curled(curl, tbar, wet(50).data()))), wanted, 0.02 * wanted);
        }
}

TEST(Curled, to_a_contraction_shortens_the_axial_extent_by_it) {
    for (int n : {50, 100}) {
        const auto tbar = intrinsic_shape(dry_helix(n));
        const double dry = axial_extent(dry_helix(n));
        for (double contraction : {0.9, 0.75, 0.6}) {
            const auto out = curled(to_contraction(contraction), tbar, wet(size_t(n)).data());
            EXPECT_NEAR(axial_extent(shape_of(out)) / dry, contraction, 0.02 * contraction) << n;
        }
    }
}

// Fitting: the helix that the strand already has is found again, hand and phase.
TEST(Curled, to_the_helix_that_it_is_changes_nothing) {
    for (double hand : {1.0, -1.0}) {
        Points p = dry_helix();
        for (auto& x : p) x.z *= hand;
        const auto tbar = intrinsic_shape(p);
        // Radius and pitch whose polyline of these segments is the one sampled above.
        const double l = norm(tbar[1]), turn = (0.25 / 49) / std::hypot(0.006, 0.025 / (2 * pi));
        const double rise = std::sqrt(l * l - std::pow(2 * 0.006 * std::sin(turn / 2), 2));
        const Curl curl = to_helix(0.006, 2 * pi * rise / turn);
        const auto out = curled(curl, tbar, wet(50).data());
        for (size_t i = 2; i < tbar.size(); ++i) EXPECT_LT(norm(out[i] - tbar[i]), 0.03 * l) << i;
    }
}

TEST(Curled, an_arc_is_no_curl) {
    Points p;
    for (int i = 0; i < 60; ++i) p.push_back({0.08 * std::cos(0.05 * i), 0.08 * std::sin(0.05 * i), 0});
    const auto tbar = intrinsic_shape(p), out = curled(to_contraction(0.7), tbar, wet(60).data());
    for (size_t i = 0; i < tbar.size(); ++i) EXPECT_LT(norm(out[i] - tbar[i]), 1e-12) << i;
}

// Points that wind about an arc in the plane z = 0 of radius `bend`, from (bend, 0, 0) on.
Points wound_about_an_arc(int n, double bend, double angle, double radius, double turns) {
    Points p;
    for (int i = 0; i < n; ++i) {
        const double s = i / double(n - 1), t = 2 * pi * turns * s, out = bend + radius * std::cos(t);
        p.push_back({out * std::cos(angle * s), out * std::sin(angle * s), radius * std::sin(t)});
    }
    return p;
}

TEST(Curled, winds_about_the_axis_that_the_dry_strand_has) {
    constexpr int n = 120;
    constexpr double bend = 0.1, angle = 1.8, radius = 0.006, contraction = 0.75;
    for (double turns : {7.0, -7.0, 5.0}) {
        const Points p = wound_about_an_arc(n, bend, angle, radius, turns);
        const auto tbar = intrinsic_shape(p);
        const Points seen =
            shape_from_intrinsic(curled(to_contraction(contraction), tbar, wet(n).data()), p[0],
                                 root_frame_of(normalized(p[1] - p[0], Vec3d{1, 0, 0})));
        // Contracted by nothing, it is as it was.
        const auto same = curled(to_contraction(1), tbar, wet(n).data());
        for (size_t i = 0; i < tbar.size(); ++i) EXPECT_LT(norm(same[i] - tbar[i]), 1e-3 * norm(tbar[i]));
        // From half a turn after the root on: how far from the arc, and in the end at which angle of it.
        double least = 1, most = 0;
        for (int i = n / 10; i < n; ++i) {
            const auto& x = seen[size_t(i)];
            const double off = std::hypot(std::hypot(x.x, x.y) - bend, x.z);
            least = std::min(least, off);
            most = std::max(most, off);
        }
        const double reached = std::atan2(seen.back().y, seen.back().x) / angle;
        std::printf("wet curl %.1f to %.1f mm from the arc, reaches %.3f of it\n", 1e3 * least, 1e3 * most,
                    reached);
        EXPECT_GT(least, 0.002);
        EXPECT_LT(most, 0.009);
        EXPECT_NEAR(reached, contraction, 0.03);
        // Damp, or with dry tips, it reaches less far than dry and further than drenched.
        auto rooted = wet(n);
        std::fill(rooted.begin() + n / 2, rooted.end(), 0.f);
        for (const auto& sigma : {wet(n, 0.5f), rooted}) {
            const Points part =
                shape_from_intrinsic(curled(to_contraction(contraction), tbar, sigma.data()), p[0],
                                     root_frame_of(normalized(p[1] - p[0], Vec3d{1, 0, 0})));
            EXPECT_NEAR(std::atan2(part.back().y, part.back().x) / angle, (1 + contraction) / 2, 0.05);
            EXPECT_LT(std::hypot(std::hypot(part.back().x, part.back().y) - bend, part.back().z), 0.009);
        }
    }
}

TEST(Curled, a_flat_coil_stays_one) {
    for (double pitch : {0.0, 0.0005, 0.002}) {
        const auto tbar = intrinsic_shape(helix_points(200, 0.25, 0.006, pitch));
        const auto out = curled(to_contraction(0.75), tbar, wet(200).data());
        for (size_t i = 0; i < tbar.size(); ++i) EXPECT_LT(norm(out[i] - tbar[i]), 1e-9) << pitch << " " << i;
        for (const auto& t : curled(to_helix(0.004, 0.01), tbar, wet(200).data()))
            EXPECT_TRUE(std::isfinite(norm(t)));
    }
}

TEST(Curled, half_wet_lies_between_about_the_same_axis) {
    const Points dry = dry_helix();
    const auto tbar = intrinsic_shape(dry);
    const double whole = axial_extent(dry);
    Eigen::Vector3d axis;
    for (float sigma : {0.f, 0.5f, 1.f}) {
        const Points seen =
            shape_from_intrinsic(curled(to_contraction(0.75), tbar, wet(50, sigma).data()), dry[0],
                                 root_frame_of(normalized(dry[1] - dry[0], Vec3d{1, 0, 0})));
        const Eigen::Vector3d found = helix_axis(seen);
        if (sigma == 0) axis = found;
        EXPECT_NEAR(axial_extent(seen) / whole, 1 - 0.25 * sigma, 0.04) << sigma;
        EXPECT_GT(std::abs(axis.dot(found)), std::cos(0.12)) << sigma;
    }
}

TEST(Curled, a_straight_strand_stays_finite) {
    const auto tbar = intrinsic_shape(straight_points(20, 0.2, {0, -1, 0}));
    for (const auto& t : curled(to_contraction(0.7), tbar, wet(20).data()))
        EXPECT_TRUE(std::isfinite(norm(t)));
    for (const auto& t : curled(to_helix(0, 0.02), tbar, wet(20).data())) EXPECT_TRUE(std::isfinite(norm(t)));
}

// --- adhesion (Eq 11, 12)

constexpr double range = 0.01, strength = 60;
Adhesion adhesion(double hold = 0) { return {strength, range, hold}; }

// One strand whose particles lie at phi = share * range from a surface with normal n, wet and touching.
OneStrand near_surface(const std::vector<double>& share, const Vec3d& n) {
    OneStrand s(straight_points(int(share.size()), 0.05, {1, 0, 0}));
    for (size_t i = 0; i < share.size(); ++i) {
        s.phi[i] = share[i] * range;
        s.normal[i] = n;
        s.saturation[i] = 1;
        s.touching[i] = 1;
    }
    return s;
}
std::vector<double> shares() {
    std::vector<double> out;
    for (int k = 0; k <= 60; ++k) out.push_back(-0.1 + 0.02 * k);  // -0.1 to 1.1
    return out;
}

TEST(Adhesion, pulls_along_the_normal_on_the_shell_alone_and_never_beyond_its_strength) {
    const Vec3d n = normalized(Vec3d{1, 2, -2}, Vec3d{1, 0, 0});
    OneStrand s = near_surface(shares(), n);
    const Points f = unstacked(force_of(adhesion(), s.view()));
    double strongest = 0;
    for (size_t i = 1; i < f.size(); ++i) {
        const double pull = -dot(f[i], n), most = strength * s.mass[i];
        EXPECT_LT(norm(f[i] + pull * n), 1e-15 * most);
        EXPECT_GE(pull, 0);
        EXPECT_LE(pull, most * (1 + 1e-12));
        const double q = s.phi[i] / range;
        EXPECT_EQ(pull > 0, q > 0.5 && q < 1) << q;
        strongest = std::max(strongest, pull / most);
    }
    EXPECT_NEAR(strongest, 1, 0.02);  // peak 1 at q = 3/4
}

TEST(Adhesion, is_zero_where_dry_or_out_of_touch_and_proportional_to_saturation) {
    OneStrand s = near_surface({0.7, 0.7, 0.7, 0.7, 0.7}, {0, 1, 0});
    s.saturation = {1, 1, 0, 0.25, 1};
    s.touching = {1, 1, 1, 1, 0};
    const Points f = unstacked(force_of(adhesion(50), s.view()));
    EXPECT_LT(f[1].y, 0);
    EXPECT_EQ(norm(f[2]), 0);
    EXPECT_NEAR(f[3].y, 0.25 * f[1].y, 1e-15 * std::abs(f[1].y));
    EXPECT_EQ(norm(f[4]), 0);
}

TEST(Adhesion, shape_is_once_differentiable_at_both_ends_and_its_slope_is_its_derivative) {
    for (double q = 0.4; q < 1.1; q += 0.0125) {
        double above, below, slope, ignored;
        const double d = 1e-6;
        Adhesion::shape(q + d, above, ignored);
        Adhesion::shape(q - d, below, ignored);
        Adhesion::shape(q, ignored, slope);
        EXPECT_NEAR((above - below) / (2 * d), slope, 3e-4)
            << q;  // across an end the second derivative jumps by 128
    }
    double value, slope;
    for (double end : {0.5, 1.0}) {
        Adhesion::shape(end, value, slope);
        EXPECT_EQ(value, 0);
        EXPECT_EQ(slope, 0);
    }
}

TEST(Adhesion, akincis_shape_peaks_at_one_and_ends_at_the_shell) {
    EXPECT_NEAR(Adhesion::akinci_shape(0.75), 1, 1e-12);
    EXPECT_EQ(Adhesion::akinci_shape(0.49), 0);
    EXPECT_EQ(Adhesion::akinci_shape(1.01), 0);
    for (double q = 0.52; q < 1; q += 0.02)
        EXPECT_NEAR(Adhesion::akinci_shape(q), std::pow(4 * (-4 * q * q + 6 * q - 2), 0.25), 1e-12);
}

TEST(Adhesion, holds_against_sliding_below_half_its_range_and_not_against_lifting) {
    OneStrand s = near_surface({0.2, 0.2, 0.2, 0.7}, {0, 1, 0});
    s.v = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 0, 0}};
    s.surface_velocity.assign(4, Vec3d{0, 0, 2});
    const Points f = unstacked(force_of(adhesion(50), s.view()));
    EXPECT_LT(norm(f[1] + 50 * s.mass[1] * Vec3d{1, 0, -2}), 1e-15);
    EXPECT_LT(norm(f[2] + 50 * s.mass[2] * Vec3d{0, 0, -2}), 1e-15);
    EXPECT_EQ(f[3].x, 0);
    EXPECT_GT(norm(f[1]), 1e-6);
}

TEST(Adhesion, its_matrix_is_the_rising_part_of_the_force_and_the_drag) {
    const double h = 0.002;
    OneStrand s = near_surface({0.6, 0.6, 0.9, 0.2}, {0, 1, 0});
    const Eigen::MatrixXd k = assembled(adhesion(50), s.view(), h).matrix;
    double value, slope;
    Adhesion::shape(0.6, value, slope);
    EXPECT_GT(slope, 0);
    EXPECT_NEAR(k(4, 4), h * h * s.mass[1] * strength * slope / range, 1e-12 * k(4, 4));
    EXPECT_EQ(k(3, 3), 0);
    EXPECT_EQ(k(7, 7), 0);  // the falling part would be negative
    EXPECT_NEAR(k(9, 9), h * 50 * s.mass[3], 1e-12 * k(9, 9));
    EXPECT_EQ(k(10, 10), 0);
}

TEST(Adhesion, pulls_no_further_in_a_step_than_to_where_it_ends) {
    OneStrand s = near_surface({0.6, 0.75, 0.9, 0.2}, {0, 1, 0});
    for (double h : {1e-4, 0.02, 1.0}) {
        const Points f = unstacked(assembled(adhesion(0), s.view(), h).force);
        for (int i = 1; i < 3; ++i) {
            const double way = h * h * norm(f[size_t(i)]) / s.mass[size_t(i)];
            EXPECT_GT(way, 0);
            EXPECT_LE(way, (s.phi[size_t(i)] - 0.5 * range) * (1 + 1e-12)) << h;
        }
    }
}

PosedSolid<double> posed(const Shape& shape, const Vec3d& at, double friction = 0) {
    return {&shape, Quatd::identity(), at, {0, 0, 0}, {0, 0, 0}, friction, false};
}

TEST(Adhesion, of_a_sphere_and_of_a_plane_agree_at_equal_distance) {
    const Shape sphere = Sphere{0.1}, plane = Plane{};
    const std::vector<PosedSolid<double>> on_sphere{posed(sphere, {0, 0, 0})},
        on_plane{posed(plane, {0, 0.1, 0})};
    double sizes[2];
    int k = 0;
    for (const auto& solids : {on_sphere, on_plane}) {
        OneStrand s = near_surface({0, 0}, {0, 0, 0});
        s.x[1] = {0, 0.1 + 0.7 * range, 0};
        sample_nearest(solids, 2, s.x.data(), s.phi.data(), s.normal.data(), s.surface_velocity.data());
        EXPECT_NEAR(s.phi[1], 0.7 * range, 1e-15);
        const Points f = unstacked(force_of(adhesion(), s.view()));
        EXPECT_EQ(f[1].x, 0);
        sizes[k++] = f[1].y;
    }
    EXPECT_LT(sizes[0], -1e-6);
    EXPECT_NEAR(sizes[0], sizes[1], 1e-12 * std::abs(sizes[1]));
}

TEST(Contact, the_flag_comes_at_the_surface_and_goes_beyond_the_range) {
    double touching = 0;
    const double way[] = {0.02, 0.005, 0.0009, 0.005, 0.0099, 0.011, 0.005};
    const double flag[] = {0, 0, 1, 1, 1, 0, 0};
    for (int k = 0; k < 7; ++k) {
        update_touching(1, &way[k], range, &touching);
        EXPECT_EQ(touching, flag[k]) << k;
    }
}

// --- contact

TEST(Contact, puts_particles_on_the_surface_takes_their_inward_velocity_and_keeps_the_history) {
    const Shape sphere = Sphere{0.1};
    for (double friction : {0.0, 1e6}) {
        OneStrand s(straight_points(4, 0.03, {1, 0, 0}));
        s.x[2] = {0, 0.08, 0};
        s.x[3] = {0, 0.2, 0};
        s.v[2] = s.v[3] = {1, -2, 0};
        Points x_before = s.x, v_before = s.v;
        x_before[2].x -= 0.01;
        v_before[2].x -= 0.1;
        std::vector<double> pushed(4, 0.0);
        resolve_contact(posed(sphere, {0, 0, 0}, friction), friction, 4, static_cast<const double*>(nullptr),
                        static_cast<const double*>(nullptr), 0.01, s.mass.data(), pushed.data(), s.x.data(),
                        x_before.data(), s.v.data(), v_before.data());
        EXPECT_NEAR(pushed[2], s.mass[2] * 0.02 / 0.01, 1e-15);
        EXPECT_EQ(pushed[3], 0);
        EXPECT_NEAR(norm(s.x[2]), 0.1, 1e-15);
        EXPECT_NEAR(s.v[2].y, 0, 1e-15);
        EXPECT_NEAR(s.v[2].x, friction > 0 ? 0 : 1, 1e-15);
        EXPECT_LT(norm(s.x[2] - x_before[2] - Vec3d{0.01, 0, 0}), 1e-15);
        EXPECT_LT(norm(s.v[2] - v_before[2] - Vec3d{0.1, 0, 0}), 1e-15);
        EXPECT_EQ(s.x[3].y, 0.2);
        EXPECT_EQ(s.v[3].y, -2);
    }
}

TEST(Contact, leaves_hair_as_deep_as_it_was_drawn_into_what_is_attached) {
    const Shape sphere = Sphere{0.1};
    PosedSolid<double> head = posed(sphere, {0, 0, 0});
    head.attached = true;
    OneStrand s(straight_points(4, 0.03, {1, 0, 0}));
    s.x[2] = {0, 0.094, 0};
    s.x[3] = {0.09, 0, 0};
    const double allowed[] = {0, 0, -0.005, -0.02};
    Points x_before = s.x, v_before = s.v;
    std::vector<double> pushed(4, 0.0);
    resolve_contact(head, 0, 4, allowed, static_cast<const double*>(nullptr), 0.01, s.mass.data(),
                    pushed.data(), s.x.data(), x_before.data(), s.v.data(), v_before.data());
    EXPECT_NEAR(s.x[2].y, 0.095, 1e-15);
    EXPECT_EQ(s.x[3].x, 0.09);
}

// One row, m d = h m g, of a particle on a plane: held, it takes the weight's momentum and no more.
TEST(Contact, a_held_particle_bears_its_weight_and_a_pulled_one_is_let_go) {
    const Shape plane = Plane{};
    const std::vector<PosedSolid<double>> solids{posed(plane, {0, 0, 0}, 0.3)};
    const double mass = 2e-8, h = 1.0 / 360;
    const Vec3d still{0, 0, 0};
    auto solved = [&](double height, double pull, double pushed, Vec3d& d) {
        const Hold<double> hold =
            expected_contact(solids, 0.0, 100 * mass, Vec3d{0.2, height, 0.1}, still, pushed);
        Sym3<double> row = identity_times(mass);
        Vec3d r{0, h * mass * pull, 0};
        add_hold(hold, h, still, row, r);
        d = Factor3<double>(row).solve(r);
        return pushed_by(hold, h, d);
    };
    Vec3d d;
    EXPECT_NEAR(solved(0, -9.81, 1, d), mass * h * 9.81, 0.01 * mass * h * 9.81);
    EXPECT_LT(std::abs(d.y), 0.01 * h * 9.81);
    solved(-1e-4, 0, 1, d);  // a gap is closed within the step
    EXPECT_NEAR(h * d.y, 1e-4, 1e-6);
    EXPECT_EQ(solved(0, 5, 1, d), 0);         // pulled away: not pushed any more
    EXPECT_EQ(solved(1e-3, -9.81, 1, d), 0);  // on its way out
    EXPECT_NEAR(d.y, -h * 9.81, 1e-15);
    EXPECT_EQ(solved(0, -9.81, 0, d), 0);  // never pushed
    EXPECT_NEAR(d.y, -h * 9.81, 1e-15);
}

// A particle on a slope whose friction holds 0.3 of the push: above it slides as Coulomb says, below it
// stays.
TEST(Contact, friction_slows_what_slides_and_keeps_what_does_not) {
    const Shape plane = Plane{};
    const std::vector<PosedSolid<double>> solids{posed(plane, {0, 0, 0}, 0.3)};
    const double mass = 2e-8, h = 1e-4, g = 9.81;
    auto speed_after = [&](double slope, double speed, double seconds) {
        const Vec3d pull{g * std::sin(slope), -g * std::cos(slope), 0};
        Vec3d v{speed, 0, 0};
        double pushed = h * mass * g * std::cos(slope);
        for (int k = 0; k < std::lround(seconds / h); ++k) {
            const Hold<double> hold = expected_contact(solids, 0.0, 1e4 * mass, Vec3d{0, 0, 0}, v, pushed);
            Sym3<double> row = identity_times(mass);
            Vec3d d = h * mass * pull;
            add_hold(hold, h, v, row, d);
            d = Factor3<double>(row).solve(d);
            v += d;
            pushed = pushed_by(hold, h, d);
        }
        return v.x;
    };
    for (double slope : {0.5, 0.0})
        EXPECT_NEAR(speed_after(slope, 2, 0.1), 2 + 0.1 * g * (std::sin(slope) - 0.3 * std::cos(slope)),
                    1e-2);
    EXPECT_NEAR(speed_after(0.5, 0, 0.1), 0.1 * g * (std::sin(0.5) - 0.3 * std::cos(0.5)), 5e-2);
    for (double speed : {0.0, 0.1}) EXPECT_LT(std::abs(speed_after(0.25, speed, 0.3)), 1.1e-6);
}

// --- wetness

ProceduralGroom small_groom(int width) {
    ProceduralGroom g;
    read_parameters(g, procedural_parameters, Config::parse("", "defaults").root());
    g.width = g.height = width;
    g.particles = 12;
    return g;
}
Wetness wetness(const std::string& pattern) {
    Wetness w;
    read_parameters(w, Wetness::parameters, Config::parse("", "defaults").root());
    w.pattern = pattern;
    return w;
}

TEST(Wetness, nested_grids_are_equally_wet) {
    const Groom fine = make_procedural(small_groom(8)), coarse = make_procedural(small_groom(4));
    for (const char* pattern : {"uniform", "tip", "root", "region"}) {
        Wetness w = wetness(pattern);
        w.jitter = 0.6;
        w.region_center = {0, 0.1, 0};
        const auto all = saturation_of(w, fine, 7), half = saturation_of(w, coarse, 7);
        double least = 1, most = 0;
        for (int row = 0; row < 4; ++row)
            for (int column = 0; column < 4; ++column)
                for (int i = 0; i < 12; ++i) {
                    const float a = half[size_t(coarse.grid.at(column, row)) * 12 + size_t(i)];
                    EXPECT_EQ(a, all[size_t(fine.grid.at(2 * column, 2 * row)) * 12 + size_t(i)]);
                    least = std::min(least, double(a));
                    most = std::max(most, double(a));
                }
        EXPECT_GT(most - least, 0.2) << pattern;
    }
}

TEST(Wetness, patterns_wet_what_their_name_says) {
    const Groom groom = make_procedural(small_groom(4));
    auto at = [&](const std::vector<float>& sigma, int i) { return sigma[5 * 12 + size_t(i)]; };
    Wetness w = wetness("uniform");
    w.level = 0.8;
    for (float s : saturation_of(w, groom, 1)) EXPECT_EQ(s, 0.8f);
    const auto tip = saturation_of(wetness("tip"), groom, 1), root = saturation_of(wetness("root"), groom, 1);
    EXPECT_EQ(at(tip, 0), 0);
    EXPECT_EQ(at(tip, 11), 1);
    for (int i = 1; i < 12; ++i) EXPECT_GE(at(tip, i), at(tip, i - 1));
    for (int i = 0; i < 12; ++i) EXPECT_NEAR(at(tip, i) + at(root, i), 1, 1e-6);
    Wetness region = wetness("region");
    region.region_center = cast<double>(groom.rest.at(5, 6));
    const auto ball = saturation_of(region, groom, 1);
    EXPECT_EQ(at(ball, 6), 1);
    double outside = 0;
    for (size_t k = 0; k < ball.size(); ++k)
        if (norm(cast<double>(groom.rest.points[k]) - region.region_center) > region.region_radius)
            outside = std::max(outside, double(ball[k]));
    EXPECT_EQ(outside, 0);
}

TEST(Wetness, jitter_is_a_function_of_the_seed) {
    const Groom groom = make_procedural(small_groom(4));
    Wetness w = wetness("uniform");
    w.jitter = 0.5;
    EXPECT_EQ(saturation_of(w, groom, 1), saturation_of(w, groom, 1));
    EXPECT_NE(saturation_of(w, groom, 1), saturation_of(w, groom, 2));
    for (float s : saturation_of(w, groom, 1)) EXPECT_TRUE(s > 0.5f && s <= 1.f);
}

}  // namespace
}  // namespace wetcurl
