// The neighbour grid and its lists against comparing all pairs.
#include <algorithm>

#include "base/geometry/neighbor_list.h"
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
        if (norm(grid.sorted(k) - x) < radius) found.push_back(grid.order()[k]);
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
    for (size_t k = 0; k < p.size(); ++k) EXPECT_EQ(norm(grid.sorted(k) - p[order[k]]), 0);
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

// Lists of a cloud in three groups; points beyond x = `source_above` are sources.
struct Listed {
    NeighborGrid grid;
    std::vector<uint32_t> group;
    std::vector<float> source;
    NeighborList list;
    Listed(const std::vector<Vec3f>& p, float radius, float source_above,
           const std::vector<float>* weight = nullptr) {
        grid.build(p.data(), p.size(), radius, weight);
        group.resize(p.size()), source.resize(p.size() + NeighborList::padding);
        for (size_t k = 0; k < p.size(); ++k) {
            group[k] = grid.order()[k] % 3;
            grid.points().set_group(k, group[k]);
            source[k] = grid.sorted(k).x > source_above ? 1.f : 0.f;
        }
        list.build(grid, source, radius);
    }
    std::vector<uint32_t> neighbours(size_t k) const {
        std::vector<uint32_t> found;
        list.visit_neighbours(k, [&](size_t j) { found.push_back(uint32_t(j)); });
        return found;
    }
};

TEST(NeighborList, holds_each_neighbour_of_another_group_once_and_no_other) {
    const auto p = cloud(1500, 0.1, 5);
    const float radius = 0.03f;
    const Listed all(p, radius, -1);
    size_t pairs = 0;
    for (size_t k = 0; k < p.size(); ++k) {
        std::vector<uint32_t> wanted;
        for (uint32_t j = 0; j < p.size(); ++j) {
            const Vec3f d = all.grid.sorted(j) - all.grid.sorted(k);
            if (dot(d, d) < radius * radius && all.group[j] != all.group[k]) wanted.push_back(j);
        }
        EXPECT_EQ(all.neighbours(k), wanted);
        pairs += wanted.size();
    }
    EXPECT_GT(pairs, 10000u);
    EXPECT_DOUBLE_EQ(all.list.neighbours_mean(), double(pairs) / double(p.size()));
}

TEST(NeighborList, holds_none_without_weight_and_lists_for_all) {
    const auto p = cloud(1500, 0.1, 7);
    const float radius = 0.03f;
    std::vector<float> weight(p.size());
    for (size_t k = 0; k < p.size(); ++k) weight[k] = k % 5 < 2 ? 0.5f : 0.f;
    const Listed some(p, radius, -1, &weight);
    size_t pairs = 0, of_those_without = 0;
    for (size_t k = 0; k < p.size(); ++k) {
        std::vector<uint32_t> wanted;
        for (uint32_t j = 0; j < p.size(); ++j) {
            const Vec3f d = some.grid.sorted(j) - some.grid.sorted(k);
            if (dot(d, d) < radius * radius && some.group[j] != some.group[k] &&
                weight[some.grid.order()[j]] > 0)
                wanted.push_back(j);
        }
        EXPECT_EQ(some.neighbours(k), wanted);
        pairs += wanted.size();
        if (weight[some.grid.order()[k]] == 0) of_those_without += wanted.size();
    }
    EXPECT_GT(pairs, 5000u);
    EXPECT_GT(of_those_without, 2000u);
    std::vector<float> none(p.size());
    EXPECT_EQ(Listed(p, radius, -1, &none).list.neighbours_mean(), 0);
}

TEST(NeighborList, is_empty_where_no_neighbour_is_a_source) {
    const auto p = cloud(1500, 0.1, 6);
    const float radius = 0.03f;
    const Listed all(p, radius, -1), some(p, radius, 0.02f);
    size_t emptied = 0;
    for (size_t k = 0; k < p.size(); ++k) {
        const auto wanted = all.neighbours(k);
        const bool any =
            std::any_of(wanted.begin(), wanted.end(), [&](uint32_t j) { return some.source[j] > 0; });
        EXPECT_EQ(some.neighbours(k), any ? wanted : std::vector<uint32_t>{});
        emptied += !any && !wanted.empty();
    }
    EXPECT_GT(emptied, 100u);
}

// Two sheets, each a slab of the grid: in its order a whole sheet lies between a point and the one above it.
TEST(NeighborList, reaches_beyond_what_16_bits_of_fours_tell) {
    const float radius = 0.0105f, spacing = 0.01f, between = 0.009f;
    NeighborList list;
    for (const uint32_t side : {60u, 400u, 60u}) {
        std::vector<Vec3f> p{{-1, -1, 0}};  // where slabs begin
        for (uint32_t k = 0; k < 2 * side * side; ++k)
            p.push_back({spacing * float(k % side), spacing * float(k / side % side),
                         0.007f + between * float(k / (side * side))});
        NeighborGrid grid;
        grid.build(p.data(), p.size(), radius);
        for (uint32_t k = 0; k < p.size(); ++k) grid.points().set_group(k, k);
        list.build(grid, std::vector<float>(p.size() + NeighborList::padding + lanes_of<float>, 1.f), radius);
        size_t farthest = 0, pairs = 0;
        for (size_t k = 0; k < p.size(); ++k)
            list.visit_neighbours(k, [&](size_t j) {
                ASSERT_LT(norm(grid.sorted(j) - grid.sorted(k)), radius);
                farthest = std::max(farthest, j > k ? j - k : k - j), ++pairs;
            });
        // Four in a sheet, but at its border, and one in the other.
        EXPECT_EQ(pairs, 2 * (4 * side * (side - 1) + side * side));
        EXPECT_EQ(farthest > 4 * 32768, side == 400);
    }
}

TEST(NeighborList, can_be_built_again_for_a_denser_cloud_and_for_none) {
    NeighborGrid grid;
    NeighborList list;
    const std::vector<float> source(3000, 1.f);
    for (double size : {0.2, 0.05}) {
        const auto p = cloud(2500, size, 7);
        grid.build(p.data(), p.size(), 0.02f);
        for (uint32_t k = 0; k < p.size(); ++k) grid.points().set_group(k, k);
        list.build(grid, source, 0.02f);
        EXPECT_GT(list.neighbours_mean(), size < 0.1 ? 50 : 0.5);
        for (uint32_t k = 0; k < p.size(); ++k) grid.points().set_group(k, 0);
        list.build(grid, source, 0.02f);
        EXPECT_EQ(list.neighbours_mean(), 0);
    }
    grid.build(nullptr, 0, 0.02f);
    list.build(grid, source, 0.02f);
    EXPECT_EQ(list.neighbours_mean(), 0);
}

}  // namespace
}  // namespace wetcurl
