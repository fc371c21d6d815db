// Resampling, coarser grids and hashes of strands against geometry.
#include <numbers>

#include "base/strands.h"
#include "scratch.h"

namespace wetcurl {
namespace {

using testing::expect_error;
using testing::Random;

std::vector<Vec3d> helix(int n, double radius, double pitch, double turns) {
    std::vector<Vec3d> p;
    for (int i = 0; i < n; ++i) {
        const double a = 2 * std::numbers::pi * turns * i / (n - 1);
        p.push_back({radius * std::cos(a), -pitch * a / (2 * std::numbers::pi), radius * std::sin(a)});
    }
    return p;
}
double length(const std::vector<Vec3d>& p) { return arc_length(p.data(), int(p.size())); }

TEST(Resampling, keeps_a_straight_line_exactly) {
    const Vec3d root{0.1, 0.2, 0.3}, direction{0.6, 0, -0.8};
    std::vector<Vec3d> given;
    for (double t : {0.0, 0.01, 0.07, 0.08, 0.2}) given.push_back(root + t * direction);  // uneven on purpose
    const auto even = resampled(given, 11);
    for (int i = 0; i < 11; ++i)
        EXPECT_LT(norm(even[size_t(i)] - (root + (0.02 * i) * direction)), 1e-12) << i;
}

TEST(Resampling, spaces_points_evenly_by_arc_length) {
    // 60 points on 3 turns resampled to 400: chords are arcs but for curvature, (1 - s^2 / 24 R^2), the same
    // for all.
    const auto even = resampled(helix(60, 0.01, 0.02, 3), 400);
    double least = 1, most = 0;
    for (size_t i = 0; i + 1 < even.size(); ++i) {
        const double d = norm(even[i + 1] - even[i]);
        least = std::min(least, d);
        most = std::max(most, d);
    }
    EXPECT_GT(least, 1e-4);
    EXPECT_LT(most / least - 1, 1e-2);
}

TEST(Resampling, keeps_both_ends) {
    const auto given = helix(30, 0.01, 0.02, 2);
    const auto even = resampled(given, 50);
    EXPECT_LT(norm(even.front() - given.front()), 1e-15);
    EXPECT_LT(norm(even.back() - given.back()), 1e-12);
}

TEST(Resampling, stays_close_to_a_helix) {
    const double radius = 0.01, pitch = 0.02, turns = 3;
    // 20 points a turn; a cubic through them misses the circle by far less than its sagitta of 1.2 % of the
    // radius.
    const auto even = resampled(helix(61, radius, pitch, turns), 200);
    double worst = 0;
    for (size_t i = 10; i + 10 < even.size(); ++i)
        worst = std::max(worst, std::abs(std::hypot(even[i].x, even[i].z) - radius));
    EXPECT_LT(worst, 2e-3 * radius);
    const double exact = turns * std::hypot(2 * std::numbers::pi * radius, pitch);
    EXPECT_NEAR(length(even) / exact, 1, 3e-3);
}

TEST(Resampling, survives_repeated_points) {
    const auto even = resampled({{0, 0, 0}, {0, 0, 0}, {0, -0.1, 0}, {0, -0.1, 0}}, 3);
    EXPECT_NEAR(even[1].y, -0.05, 1e-12);
}

TEST(Resampling, refuses_a_strand_without_length_and_fewer_than_two_particles) {
    expect_error([] { resampled({{1, 2, 3}, {1, 2, 3}}, 5); }, {"two distinct points"});
    expect_error([] { resampled({}, 5); }, {"two distinct points"});
    expect_error([] { resampled({{0, 0, 0}, {1, 0, 0}}, 1); }, {"found 1", "2 or more"});
}

TEST(ArcLength, of_a_polyline_is_the_sum_of_its_edges) {
    const std::vector<Vec3d> p{{0, 0, 0}, {3, 4, 0}, {3, 4, 12}};
    EXPECT_DOUBLE_EQ(length(p), 17);
    const std::vector<Vec3f> f{{0, 0, 0}, {3, 4, 0}, {3, 4, 12}};
    EXPECT_DOUBLE_EQ(arc_length(f.data(), 3), 17);
}

// width x height roots at the corners of a grid, some pixels empty.
Groom grid_groom(int width, int height, bool holes) {
    Groom g;
    g.grid = {width, height, std::vector<int>(size_t(width) * size_t(height), -1)};
    std::vector<std::pair<int, int>> places;  // (column, row)
    for (int row = 0; row < height; ++row)
        for (int column = 0; column < width; ++column)
            if (!holes || (row * 7 + column * 3) % 5) {
                g.grid.strand[size_t(row) * size_t(width) + size_t(column)] = int(places.size());
                places.push_back({column, row});
            }
    g.rest = Strands(int(places.size()), 3);
    for (int s = 0; s < g.rest.count; ++s) {
        const auto [column, row] = places[size_t(s)];
        for (int i = 0; i < 3; ++i) g.rest.at(s, i) = {float(column), float(-i), float(row)};
        g.normal.push_back({0, 1, 0});
    }
    return g;
}

TEST(Coarsened, grid_is_every_second_root_each_way) {
    const Groom full = grid_groom(8, 6, false);
    std::vector<int> kept;
    const Groom half = coarsened(full, 2, &kept);
    ASSERT_EQ(half.grid.width, 4);
    ASSERT_EQ(half.grid.height, 3);
    ASSERT_EQ(half.rest.count, 12);
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 4; ++column) {
            const int s = half.grid.at(column, row), f = full.grid.at(2 * column, 2 * row);
            EXPECT_EQ(kept[size_t(s)], f);
            for (int i = 0; i < 3; ++i) EXPECT_EQ(norm(half.rest.at(s, i) - full.rest.at(f, i)), 0);
        }
}

TEST(Coarsened, twice_by_two_is_once_by_four_even_with_holes) {
    const Groom full = grid_groom(16, 12, true);
    const Groom twice = coarsened(coarsened(full, 2), 2), once = coarsened(full, 4);
    ASSERT_GT(once.rest.count, 4);
    ASSERT_LT(once.rest.count, 12);
    EXPECT_EQ(twice.hash(), once.hash());
    EXPECT_EQ(coarsened(full, 1).hash(), full.hash());
}

TEST(Coarsened, refuses_a_stride_below_one) {
    expect_error([] { coarsened(grid_groom(4, 4, false), 0); }, {"found 0", "1 or more"});
}

TEST(Hash, of_a_groom_changes_with_a_point_and_with_the_grid) {
    const Groom a = grid_groom(4, 4, false);
    Groom moved = a, relaid = a;
    moved.rest.at(3, 1).y += 1e-6f;
    std::swap(relaid.grid.strand[0], relaid.grid.strand[1]);
    EXPECT_NE(a.hash(), moved.hash());
    EXPECT_NE(a.hash(), relaid.hash());
    EXPECT_EQ(a.hash(), grid_groom(4, 4, false).hash());
}

TEST(Hash, is_fnv_1a) {
    // Published values of FNV-1a 64: "" and "a".
    EXPECT_EQ(hash_bytes("", 0, 14695981039346656037ull), "cbf29ce484222325");
    EXPECT_EQ(hash_bytes("a", 1, 14695981039346656037ull), "af63dc4c8601ec8c");
}

}  // namespace
}  // namespace wetcurl
