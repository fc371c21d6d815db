// Metrics against analysis.
#include "app/measures/metrics.h"
#include "learn/codec/core_detail.h"
#include "tests/learn/hair.h"

namespace wetcurl::testing {
namespace {

constexpr int frames = 6;
Pose still(int) { return {}; }

struct Case {
    Scratch scratch;
    Groom groom = curly_groom({});
    std::string reference = scratch.path("reference.h5"), other = scratch.path("other.h5");

    using Bend = std::function<Vec3d(int, int, int)>;
    Comparison compared(const Bend& a, const Bend& b, const std::function<Pose(int)>& head = head_at,
                        int first_frame = 0, const SolidDistance& solid = {}) {
        write_run(reference, groom, 1, frames, {}, a, head);
        write_run(other, groom, 1, frames, {}, b, head);
        return compare(RunReader(reference), RunReader(other), first_frame, solid);
    }
};

Vec3d none(int, int, int) { return {0, 0, 0}; }

TEST(Compare, a_run_against_itself_is_perfect) {
    Case c;
    const Comparison r = c.compared(none, none);
    EXPECT_EQ(r.frames, frames);
    EXPECT_EQ(r.position_mm.max, 0);
    EXPECT_EQ(r.f1, (std::array<double, 3>{1, 1, 1}));
    EXPECT_EQ(r.curvature_error, 0);
    EXPECT_EQ(r.curl_radius_ratio, 1);
    EXPECT_EQ(r.tip_spread_ratio, 1);
    EXPECT_EQ(r.velocity_error, 0);
    EXPECT_EQ(r.clumps, r.clumps_reference);
    EXPECT_GT(r.tip_spread_mm, 1);
    EXPECT_NEAR(r.stretch_max, 0, 1e-4);
    EXPECT_DOUBLE_EQ(r.seconds_per_frame, 0.5);
    EXPECT_DOUBLE_EQ(r.seconds_per_frame_reference, 0.5);
    EXPECT_EQ(r.mm_per_frame, std::vector<double>(frames, 0));
    EXPECT_EQ(r.kind, "simulated");
}

TEST(Compare, a_rigid_shift_of_a_millimetre_is_a_millimetre) {
    Case c;
    const Comparison r = c.compared(none, [](int, int, int) { return Vec3d{0, 0.6e-3, 0.8e-3}; });
    for (const Spread& s : {r.position_mm, r.shared_mm, r.new_mm}) {
        EXPECT_NEAR(s.mean, 1, 1e-3);
        EXPECT_NEAR(s.median, 1, 2e-3);
        EXPECT_NEAR(s.p95, 1, 2e-3);
        EXPECT_NEAR(s.max, 1, 1e-3);
    }
    double relative = 0;
    for (int s = 0; s < c.groom.rest.count; ++s)
        relative += 1e-3 / arc_length(c.groom.rest.strand(s), 50) / c.groom.rest.count;
    EXPECT_NEAR(r.position_rel, relative, 1e-6);
    // It stands still in the head's frame.
    EXPECT_NEAR(r.static_mm, 1, 1e-3);
    EXPECT_NEAR(r.dynamic_mm, 0, 1e-2);
    EXPECT_NEAR(r.f1[0], 1, 1e-12);
    EXPECT_NEAR(r.curl_radius_ratio, 1, 1e-4);
}

TEST(Compare, the_error_of_each_frame_is_told_apart) {
    Case c;
    // A millimetre more each frame; frame 0 is left out.
    const Comparison r = c.compared(
        none,
        [](int, int, int f) {
            return Vec3d{0, 1e-3 * f, 0};
        },
        head_at, 1);
    ASSERT_EQ(r.mm_per_frame.size(), size_t(frames - 1));
    for (size_t k = 0; k < r.mm_per_frame.size(); ++k) EXPECT_NEAR(r.mm_per_frame[k], double(k + 1), 1e-3);
}

TEST(Compare, shared_and_new_roots_are_told_apart) {
    Case c;
    // Only strands of even rows and columns move.
    const Comparison r = c.compared(none, [](int s, int, int) {
        return Vec3d{s % 2 == 0 && (s / 8) % 2 == 0 ? 0.002 : 0, 0, 0};
    });
    EXPECT_NEAR(r.shared_mm.mean, 2, 1e-3);
    EXPECT_NEAR(r.new_mm.mean, 0, 1e-3);
    EXPECT_NEAR(r.position_mm.mean, 0.5, 1e-3);
    EXPECT_NEAR(r.position_mm.median, 0, 2e-3);
    EXPECT_NEAR(r.position_mm.p95, 2, 1e-2);
}

TEST(Compare, shared_strands_are_those_that_a_run_names) {
    Case c;
    // Strand s is off by s millimetres.
    c.compared(none, [](int s, int, int) { return Vec3d{1e-3 * s, 0, 0}; });
    const RunReader other(c.other);
    RunHeader header = other.header();
    EXPECT_FALSE(header.followed);
    header.followed = std::vector<int>{3, 5};
    const std::string named = c.scratch.path("named.h5");
    RunWriter writer(named, header, false);
    for (int f = 0; f < frames; ++f) writer.append(other.frame(f));
    writer.commit();
    const Comparison r = compare(RunReader(c.reference), RunReader(named), 0, {});
    EXPECT_NEAR(r.shared_mm.mean, 4, 1e-3);
    const double others = 0.5 * 63 * 64 - 8;
    EXPECT_NEAR(r.new_mm.mean, others / 62, 1e-2);
    // Of guides that are none of the strands, none is shared.
    header.followed = std::vector<int>{};
    const std::string none_shared = c.scratch.path("none_shared.h5");
    RunWriter alone(none_shared, header, false);
    for (int f = 0; f < frames; ++f) alone.append(other.frame(f));
    alone.commit();
    ASSERT_TRUE(RunReader(none_shared).header().followed);
    EXPECT_NEAR(compare(RunReader(c.reference), RunReader(none_shared), 0, {}).new_mm.mean, 0.5 * 63, 1e-2);
}

TEST(Compare, strands_are_told_apart_from_what_is_seen_of_them) {
    Case c;
    const auto bend = [](int, int, int) { return Vec3d{0, 0, 2e-3}; };
    write_run(c.reference, c.groom, 1, frames, {}, none, still, {3e-3f, 0, 0});
    write_run(c.other, c.groom, 1, frames, {}, bend, still, {3e-3f, 0, 1e-3f});
    const RunReader reference(c.reference);
    const Comparison both = compare(reference, RunReader(c.other), 0, {});
    EXPECT_NEAR(both.strands_mm.value(), 2, 1e-3);
    EXPECT_NEAR(both.position_mm.mean, 3, 1e-3);
    write_run(c.other, c.groom, 1, frames, {}, bend, still);
    EXPECT_FALSE(compare(reference, RunReader(c.other), 0, {}).strands_mm);
}

TEST(Compare, a_swaying_error_is_dynamic) {
    Case c;
    const Comparison r = c.compared(none, [](int, int, int f) { return Vec3d{0, f % 2 ? 1e-3 : -1e-3, 0}; });
    EXPECT_NEAR(r.static_mm, 0, 1e-3);
    EXPECT_NEAR(r.dynamic_mm, 1, 1e-3);
    EXPECT_NEAR(r.velocity_error, 2e-3 * 24, 1e-4);
}

TEST(Compare, jitter_is_the_third_difference_of_a_standing_head) {
    Case c;
    auto shake = [](int, int, int f) { return Vec3d{f % 2 ? 1e-4 : -1e-4, 0, 0}; };
    const Comparison r = c.compared(none, shake, still);
    ASSERT_TRUE(r.jitter_mm && r.jitter_reference_mm);
    EXPECT_NEAR(*r.jitter_mm, 8 * 0.1, 1e-3);  // 1 + 3 + 3 + 1 times the amplitude
    EXPECT_NEAR(*r.jitter_reference_mm, 0, 1e-4);
    EXPECT_FALSE(c.compared(none, shake, head_at).jitter_mm);
}

TEST(Compare, wider_curls_and_stretched_edges_show) {
    Case c;
    // All coordinates across the axis grow by a tenth about the root's, so the curl radius does too.
    const Groom& g = c.groom;
    const Comparison wide = c.compared(none, [&](int s, int i, int) {
        const Vec3f d = g.rest.at(s, i) - g.rest.at(s, 0);
        return 0.1 * Vec3d{d.x, 0, d.z};
    });
    EXPECT_NEAR(wide.curl_radius_ratio, 1.1, 0.005);
    const Comparison stretched = c.compared(
        none, [&](int s, int i, int) { return 0.05 * cast<double>(g.rest.at(s, i) - g.rest.at(s, 0)); });
    EXPECT_NEAR(stretched.stretch_max, 0.05, 1e-4);
    EXPECT_NEAR(stretched.stretch_max_reference, 0, 1e-4);
    EXPECT_NEAR(stretched.stretch_mean, 0.05, 1e-4);
    EXPECT_NEAR(stretched.stretch_mean_reference, 0, 1e-5);
    EXPECT_NEAR(stretched.curvature_error, 1 - 1 / 1.05, 1e-3);  // 1/R shrinks as the strand grows
}

TEST(Compare, depth_counts_beyond_that_at_rest) {
    Case c;
    c.groom = curly_groom({});
    // A plane through the hair: half of it is drawn into the solid, which is allowed; what sinks further is
    // not.
    const SolidDistance solid = [](const Vec3f& x, const Pose&, double) { return x.y; };
    auto plain = c.compared(none, none, still, 0, solid);
    EXPECT_EQ(plain.penetration_fraction, 0);
    EXPECT_NEAR(plain.penetration_max_mm, 0, 1e-4);
    const Comparison sunk = c.compared(
        none,
        [](int, int, int) {
            return Vec3d{0, -0.003, 0};
        },
        still, 0, solid);
    EXPECT_NEAR(sunk.penetration_max_mm, 3, 1e-3);
    EXPECT_NEAR(plain.solid_distance_mm.mean, 0, 1e-4);
    EXPECT_NEAR(sunk.solid_distance_mm.mean, 3, 1e-3);
    double below = 0;
    for (const Vec3f& p : c.groom.rest.points) below += p.y < 0.003 - 1e-4;
    EXPECT_NEAR(sunk.penetration_fraction, below / double(c.groom.rest.points.size()), 0.003);
    EXPECT_GT(sunk.penetration_fraction, 0.3);
}

TEST(Compare, frames_before_the_first_do_not_count) {
    Case c;
    const Comparison r = c.compared(
        none,
        [](int, int, int f) {
            return Vec3d{f < 3 ? 0.005 : 0.001, 0, 0};
        },
        head_at, 3);
    EXPECT_EQ(r.frames, frames - 3);
    EXPECT_NEAR(r.position_mm.max, 1, 1e-3);
}

TEST(Compare, other_hair_or_motion_is_an_error) {
    Case c;
    write_run(c.reference, c.groom, 1, frames, {});
    const RunReader reference(c.reference);
    auto against = [&](const Groom& groom, const std::function<Pose(int)>& head, int first = 0) {
        write_run(c.other, groom, 1, frames, {}, none, head);
        compare(reference, RunReader(c.other), first, {});
    };
    expect_error([&] { against(coarsened(c.groom, 2), head_at); },
                 {"strands and particles", "16 x 50", "64 x 50"});
    expect_error([&] { against(curly_groom({}, 3), head_at); }, {c.other, "groom"});
    expect_error([&] { against(c.groom, still); }, {c.other, "frame 0", "the same motion"});
    expect_error([&] { against(c.groom, head_at, frames); }, {"first frame", "found 6", "0 to 5"});
}

TEST(OrientedF1, is_zero_far_away_and_for_turned_points) {
    const Groom groom = curly_groom({});
    Strands far = groom.rest, reversed = groom.rest;
    for (Vec3f& p : far.points) p.x += 1;
    EXPECT_EQ(oriented_f1(groom.rest, far), (std::array<double, 3>{0, 0, 0}));
    // A lone straight strand, and the same points walked from tip to root.
    Strands line(1, 20);
    for (int i = 0; i < 20; ++i) line.at(0, i) = {0, 0.01f * float(i), 0};
    reversed = line;
    std::reverse(reversed.points.begin(), reversed.points.end());
    EXPECT_EQ(oriented_f1(line, line), (std::array<double, 3>{1, 1, 1}));
    EXPECT_EQ(oriented_f1(line, reversed), (std::array<double, 3>{0, 0, 0}));
}

TEST(OrientedF1, thresholds_are_two_three_and_four_millimetres_and_tens_of_degrees) {
    Strands line(1, 20), shifted = line, turned = line;
    for (int i = 0; i < 20; ++i) {
        line.at(0, i) = {0, 0.1f * float(i), 0};
        shifted.at(0, i) = {0.0025f, 0.1f * float(i), 0};
    }
    EXPECT_EQ(oriented_f1(line, shifted), (std::array<double, 3>{0, 1, 1}));
    // Two points, the second turned by 35 degrees about the first: only the first pair is near, at 4 mm and
    // 40 degrees.
    Strands a(1, 2), b(1, 2);
    a.points = {{0, 0, 0}, {0.1f, 0, 0}};
    const float angle = 35 * std::numbers::pi_v<float> / 180;
    b.points = {{0, 0, 0}, {0.1f * std::cos(angle), 0.1f * std::sin(angle), 0}};
    EXPECT_EQ(oriented_f1(a, b), (std::array<double, 3>{0, 0, 0.5}));
}

TEST(Curvature, of_points_on_a_circle_is_one_over_its_radius) {
    for (double radius : {0.005, 2.0})
        for (double step : {0.1, 1.0}) {
            auto on = [&](double a) {
                return Vec3f{float(radius * std::cos(a)), float(radius * std::sin(a)), 0.5f};
            };
            EXPECT_NEAR(inverse_circumradius(on(1), on(1 + step), on(1 + 2 * step)) * radius, 1, 2e-4);
        }
    EXPECT_NEAR(inverse_circumradius({0, 0, 0}, {1, 1, 0}, {2, 2, 0}), 0, 1e-12);
    EXPECT_EQ(inverse_circumradius({0, 0, 0}, {0, 0, 0}, {1, 0, 0}), 0);
}

// Tips at given places.
Strands with_tips(const std::vector<Vec3f>& tips) {
    Strands out(int(tips.size()), 2);
    for (size_t s = 0; s < tips.size(); ++s) {
        out.at(int(s), 0) = tips[s] + Vec3f{0, 1, 0};
        out.at(int(s), 1) = tips[s];
    }
    return out;
}

TEST(TipSpread, of_a_square_grid_is_its_spacing) {
    std::vector<Vec3f> tips;
    for (int k = 0; k < 400; ++k) tips.push_back({0.01f * float(k % 20), 0, 0.01f * float(k / 20)});
    // Inner tips have four at the spacing; edge and corner ones reach to the diagonal or two spacings.
    const double inner = 18 * 18, edge = 4 * 18, corner = 4, diagonal = std::sqrt(2.0);
    const double expected =
        0.01 * (inner + edge * (3 + diagonal) / 4 + corner * (2 + diagonal + 2) / 4) / 400;
    EXPECT_NEAR(tip_spread(with_tips(tips)), expected, 1e-6);
    for (Vec3f& t : tips) t = 0.5f * t;
    EXPECT_NEAR(tip_spread(with_tips(tips)), expected / 2, 1e-6);
}

TEST(TipSpread, agrees_with_all_pairs_on_scattered_tips) {
    Random random(8);
    std::vector<Vec3f> tips;
    for (int k = 0; k < 300; ++k) tips.push_back(cast<float>((k % 10 ? 0.01 : 1.0) * random.vector()));
    double sum = 0;
    for (const Vec3f& a : tips) {
        std::vector<float> d;
        for (const Vec3f& b : tips)
            if (&a != &b) d.push_back(norm(a - b));
        std::sort(d.begin(), d.end());
        sum += d[0] + d[1] + d[2] + d[3];
    }
    EXPECT_NEAR(tip_spread(with_tips(tips)), sum / (4 * 300), 1e-6);
}

TEST(Clumps, are_groups_of_linked_tips) {
    std::vector<Vec3f> tips;
    for (int group = 0; group < 5; ++group)
        for (int k = 0; k < 10; ++k) tips.push_back({0.1f * float(group) + 0.002f * float(k), 0, 0});
    EXPECT_EQ(clump_count(with_tips(tips), 0.003f), 5);
    EXPECT_EQ(clump_count(with_tips(tips), 0.001f), 50);
    EXPECT_EQ(clump_count(with_tips(tips), 0.2f), 1);
}

TEST(Crowd, counts_particles_of_other_strands_in_reach) {
    // Three straight strands in a row, 3 mm apart, particles 2 mm apart along them.
    Strands row(3, 10);
    for (int s = 0; s < 3; ++s)
        for (int i = 0; i < 10; ++i) row.at(s, i) = {3e-3f * float(s), -2e-3f * float(i), 0};
    // Within 4 mm: on each strand beside it the one at its height and, 3.6 mm off, those above and below.
    const double inner = 3, end = 2, of_one = (8 * inner + 2 * end) / 10;
    EXPECT_NEAR(crowd(row, 4e-3f), of_one * 4 / 3,
                1e-9);  // the outer two have one beside them, the middle two
    EXPECT_EQ(crowd(row, 2.9e-3f), 0);
}

TEST(Clumps, link_is_half_the_roots_distance) {
    Curls curls;
    curls.spacing = 0.004;
    EXPECT_NEAR(clump_link(curly_groom(curls)), 0.002, 1e-4);
}

TEST(RankCorrelation, is_of_the_order_alone) {
    EXPECT_NEAR(rank_correlation({1, 2, 3, 4}, {1, 10, 100, 1000}), 1, 1e-12);
    EXPECT_NEAR(rank_correlation({1, 2, 3, 4}, {9, 4, 3, 0}), -1, 1e-12);
    // Equal values share their rank: 1 - 6 sum d^2 / (n (n^2 - 1)) holds without them.
    EXPECT_NEAR(rank_correlation({1, 2, 3, 4, 5}, {2, 1, 4, 3, 5}), 1 - 6 * 4 / 120.0, 1e-12);
    EXPECT_NEAR(rank_correlation({1, 1, 2, 2}, {1, 2, 3, 4}), 4 / std::sqrt(4 * 5.0), 1e-12);
    EXPECT_EQ(rank_correlation({1, 1, 1}, {1, 2, 3}), 0);
}

}  // namespace
}  // namespace wetcurl::testing
