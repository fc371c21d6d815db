// The device's search on the host against all pairs.
#include <gtest/gtest.h>

#include "tests/base/scratch.h"
#include "tests/cuda/host_search.h"

namespace wetcurl {
namespace {

using namespace testing;

constexpr int particles = 7;
constexpr double radius = 0.5;
const Vec3f origin{-7, 5, 300};

// Anywhere in a box that is wider than the grid.
std::vector<Vec3f> cloud(size_t count, unsigned seed) {
    Random random(seed);
    std::vector<Vec3f> p;
    for (size_t k = 0; k < count; ++k) p.push_back(origin + cast<float>(random.vector(5)));
    return p;
}

std::vector<uint32_t> found(const CellSearch& search, uint32_t of, const Vec3f& p) {
    std::vector<uint32_t> ids;
    search.neighbours(of, p, [&](uint32_t k, const SortedPoint& other) {
        EXPECT_EQ(search.sorted[k].id, other.id);
        ids.push_back(other.id);
    });
    return ids;
}

TEST(CellSearch, finds_what_all_pairs_find_where_the_grid_wraps_round_too) {
    const std::vector<Vec3f> p = cloud(300 * particles, 1);
    const HostSearch host(p, particles, radius, origin);
    const CellSearch& search = host.view;
    size_t pairs = 0, across = 0;
    for (uint32_t i = 0; i < search.count; ++i) {
        std::vector<uint32_t> wanted, got = found(search, i, p[i]);
        EXPECT_EQ(got, found(search, i, p[i]));
        for (uint32_t j = 0; j < search.count; ++j) {
            const Vec3f d = p[j] - p[i];
            if (i / particles == j / particles || !(dot(d, d) < float(radius * radius))) continue;
            wanted.push_back(j);
            // Cells of the two lie at either end of the grid's x.
            const int x = (1 << search.grid.bits_x) - 1;
            auto end = [&](uint32_t k) { return search.grid.cell_of(p[k] - origin).x & x; };
            across += end(i) == 0 && end(j) == x;
        }
        std::sort(got.begin(), got.end());
        EXPECT_EQ(got, wanted) << i;
        pairs += wanted.size();
    }
    EXPECT_GT(pairs, search.count);
    EXPECT_GT(across, 10u);
}

TEST(CellSearch, orders_particles_by_cells_and_in_each_by_their_numbers) {
    const std::vector<Vec3f> p = cloud(60 * particles, 3);
    const HostSearch host(p, particles, radius, origin);
    for (uint32_t k = 0; k < host.view.count; ++k) {
        const uint32_t id = host.sorted_id[k];
        EXPECT_EQ(host.sorted[k].id, id);
        EXPECT_EQ(norm(host.sorted[k].position() - p[id]), 0);
        if (k == 0) continue;
        const uint32_t before = host.sorted_id[k - 1];
        EXPECT_LT(std::pair(host.view.cell_of(p[before]), before), std::pair(host.view.cell_of(p[id]), id))
            << k;
    }
}

TEST(CellSearch, finds_none_of_what_is_far_away_or_not_finite) {
    std::vector<Vec3f> p(6 * particles, origin);
    const float inf = std::numeric_limits<float>::infinity();
    const Vec3f lost[]{{NAN, 5, 300}, {-7, inf, 300}, {1e30f, 5, 300}, {1e30f, 5, 300}};
    for (size_t s = 0; s < 4; ++s) p[s * particles + 2] = lost[s];
    const HostSearch host(p, particles, radius, origin);
    for (uint32_t i = 0; i < host.view.count; ++i) {
        const auto ids = found(host.view, i, p[i]);
        const bool is_lost = i % particles == 2 && i / particles < 4;
        // All others are at one place, and those of another strand count.
        EXPECT_EQ(ids.size(), is_lost ? 0u : 5u * particles - (i / particles < 4 ? 3 : 4)) << i;
        for (uint32_t j : ids) EXPECT_FALSE(j % particles == 2 && j / particles < 4) << j;
    }
    // They close the order.
    for (uint32_t k = 0; k < host.view.count; ++k)
        EXPECT_EQ(host.view.cell_of(p[host.sorted_id[k]]) == host.view.grid.cells(),
                  k + 4 >= host.view.count);
}

TEST(CellSearch, of_a_point_that_is_on_no_strand_finds_all_around_it) {
    const std::vector<Vec3f> p = cloud(40 * particles, 2);
    const HostSearch host(p, particles, 2, origin);
    size_t wanted = 0;
    for (const Vec3f& x : p) wanted += norm(x - origin) < 2;
    EXPECT_GT(wanted, 2u);
    EXPECT_EQ(found(host.view, host.view.count, origin).size(), wanted);
}

}  // namespace
}  // namespace wetcurl
