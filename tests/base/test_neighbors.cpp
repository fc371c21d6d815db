// The neighbour grid against comparing all pairs. Ours.
#include <algorithm>

#include "base/geometry/neighbor_grid.h"
#include "scratch.h"

namespace wetcurl {
namespace {

using testing::Random;

std::vector<Vec3f> cloud(int n, double size, unsigned seed) {
    Random random(seed);
    std::vector<Vec3f> p(static_cast<size_t>(n));
    for (auto& x : p) x = cast<float>(random.vector(size));
    return p;
}

std::vector<uint32_t> within(const NeighborGrid& grid, const Vec3f& x, float radius) {
    std::vector<uint32_t> found;
    grid.around(x, [&](uint32_t k) {
        if (norm(grid.sorted()[k] - x) < radius) found.push_back(grid.order()[k]);
    });
    std::sort(found.begin(), found.end());
    return found;
}

TEST(NeighborGrid, finds_each_point_within_the_radius_once_and_no_other) {
    const auto p = cloud(1500, 0.1, 1);
    const float radius = 0.017f;
    NeighborGrid grid;
    grid.build(p.data(), p.size(), radius);
    Random random(2);
    size_t pairs = 0;
    for (int k = 0; k < 400; ++k) {
        const Vec3f x = k < 200 ? p[size_t(k)] : cast<float>(random.vector(0.13));  // some beyond the grid
        std::vector<uint32_t> wanted;
        for (uint32_t i = 0; i < p.size(); ++i)
            if (norm(p[i] - x) < radius) wanted.push_back(i);
        EXPECT_EQ(within(grid, x, radius), wanted);
        pairs += wanted.size();
    }
    EXPECT_GT(pairs, 500u);
}

TEST(NeighborGrid, order_is_a_permutation) {
    const auto p = cloud(500, 0.1, 3);
    NeighborGrid grid;
    grid.build(p.data(), p.size(), 0.02f);
    auto order = grid.order();
    for (size_t k = 0; k < p.size(); ++k) EXPECT_EQ(norm(grid.sorted()[k] - p[order[k]]), 0);
    std::sort(order.begin(), order.end());
    for (uint32_t i = 0; i < order.size(); ++i) EXPECT_EQ(order[i], i);
}

TEST(NeighborGrid, survives_a_point_far_away_and_an_empty_cloud) {
    auto p = cloud(100, 0.1, 4);
    p.push_back({1000, 0, 0});
    NeighborGrid grid;
    grid.build(p.data(), p.size(), 0.02f);
    EXPECT_EQ(within(grid, p.back(), 0.02f), std::vector<uint32_t>{100});
    EXPECT_EQ(within(grid, {-1e30f, 1e30f, 0}, 0.02f).size(), 0u);
    grid.build(p.data(), 0, 0.02f);
    EXPECT_EQ(within(grid, {0, 0, 0}, 0.02f).size(), 0u);
}

}  // namespace
}  // namespace wetcurl
