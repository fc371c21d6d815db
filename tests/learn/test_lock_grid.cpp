// Strands drawn together by a grid: against its definition, pair by pair, and what locks must be.
#include <gtest/gtest.h>

#include "learn/codec/lock_grid.h"
#include "learn/codec/root_grid.h"
#include "tests/base/scratch.h"
#include "tests/base/threads.h"
#include "tests/learn/hair.h"

namespace wetcurl {
namespace {

using testing::Curls;
using testing::curly_groom;
using testing::expect_error;
using testing::largest_distance;
using testing::moved;
using testing::some_pose;

struct Hair {
    Groom groom;
    RootLanes lanes;
    std::vector<float> edges, saturation;
    explicit Hair(const Curls& curls = {.width = 7, .height = 5, .particles = 33})
        : groom(curly_groom(curls)),
          lanes(StrandLanes::on_grid(groom.grid, groom.rest.count), root_frames(groom)) {
        for (int s = 0; s < groom.rest.count; ++s)
            for (int i = 0; i < groom.rest.particles; ++i) {
                edges.push_back(i ? norm(groom.rest.at(s, i) - groom.rest.at(s, i - 1)) : 0);
                saturation.push_back(0.3f + 0.6f * float((s * 7 + i) % 5) / 5);
            }
    }
    // Frames in which strands lie so in the world, each at its head pose; what is shown of the last.
    Strands drawn(const LockTerms& terms, const std::vector<std::pair<Strands, Pose>>& frames) const {
        LockGrid locks(terms, lanes, groom.rest.particles, edges, saturation);
        Strands out = groom.rest;
        const int numbers = 3 * out.particles;
        for (size_t f = 0; f < frames.size(); ++f) {
            const auto& [strands, head] = frames[f];
            locks.begin(f == 0);
#pragma omp parallel
            {
#pragma omp for
                for (int block = 0; block < lanes.blocks(); ++block) {
                    lanes.load(block, numbers, &strands.points[0].x, &locks.strands(block)->x);
                    locks.take(block, head);
                }
                locks.draw();
#pragma omp for
                for (int block = 0; block < lanes.blocks(); ++block) {
                    locks.show(block, head);
                    lanes.store(block, numbers, &locks.strands(block)->x, &out.points[0].x);
                }
            }
        }
        return out;
    }
    Strands drawn(const LockTerms& terms) const { return drawn(terms, {{groom.rest, Pose()}}); }
    // Mean distance of each tip from the nearest other tip.
    static double spread(const Strands& p) {
        double sum = 0;
        for (int s = 0; s < p.count; ++s) {
            float least = 1e9f;
            for (int other = 0; other < p.count; ++other)
                if (other != s)
                    least = std::min(least, norm(p.at(s, p.particles - 1) - p.at(other, p.particles - 1)));
            sum += least;
        }
        return sum / p.count;
    }
};

LockTerms terms(float reach = 0.02f, std::vector<float> sweeps = {0.9f}) {
    return {.reach = reach, .coherence = 0, .stretch = 1000, .sweeps = std::move(sweeps), .frames = 1};
}

// The weight of two places for each other: what both leave at corners of whole numbers.
double weight(const Vec3d& a, const Vec3d& b) {
    double all = 1;
    for (const auto& [u, v] : {std::pair{a.x, b.x}, {a.y, b.y}, {a.z, b.z}}) {
        double sum = 0;
        for (double corner = std::floor(u) - 1; corner <= std::floor(u) + 2; ++corner)
            sum += std::max(0.0, 1 - std::abs(u - corner)) * std::max(0.0, 1 - std::abs(v - corner));
        all *= sum;
    }
    return all;
}

TEST(LockGrid, are_the_mean_of_what_lies_around_by_weights_of_pairs) {
    const Hair hair({.width = 7, .height = 5, .particles = 97});
    const LockTerms asked = terms();
    const double cell = std::sqrt(0.225) * asked.reach;
    const int n = hair.groom.rest.particles;
    const double edge = norm(hair.groom.rest.at(0, 2) - hair.groom.rest.at(0, 1));
    const int every = int(std::lround(0.6 * asked.reach / edge)), count = (n - 2) / every + 2;
    ASSERT_GT(every, 1);
    // Who is asked: strands of a block at the same heights, blocks at others.
    auto at = [&](int s, int j) {
        const int turn = hair.lanes.place_of(s) / Pack<float>::lanes % every;
        return j == 0 ? 0 : j < count - 1 ? j * every - turn : n - 1;
    };
    struct Asked {
        Vec3d x;  // [cells]
        double volume = 0, wet = 0;
    };
    std::vector<std::vector<Asked>> all;
    for (int s = 0; s < hair.groom.rest.count; ++s) {
        std::vector<Asked>& mine = all.emplace_back(size_t(count));
        for (int j = 0; j < count; ++j)
            mine[size_t(j)].x = (1 / cell) * cast<double>(hair.groom.rest.at(s, at(s, j)));
        for (int i = 0; i < n; ++i) {
            const size_t k = size_t(s * n + i);
            const double volume = (hair.edges[k] + (i + 1 < n ? hair.edges[k + 1] : 0)) / 2;
            for (int j = 0; j < count; ++j) {
                const double before = j > 0 ? double(i - at(s, j - 1)) / (at(s, j) - at(s, j - 1)) : -1,
                             after =
                                 j + 1 < count ? double(at(s, j + 1) - i) / (at(s, j + 1) - at(s, j)) : -1,
                             share = i == at(s, j)  ? 1
                                     : i < at(s, j) ? before
                                                    : after;
                if (share <= 0) continue;
                mine[size_t(j)].volume += share * volume;
                mine[size_t(j)].wet += share * volume * hair.saturation[k];
            }
        }
    }
    const Strands found = hair.drawn(asked);
    double most = 0;
    for (int s = 0; s < hair.groom.rest.count; ++s)
        for (int j = 1; j < count; ++j) {
            const Asked& own = all[size_t(s)][size_t(j)];
            Vec3d pull{0, 0, 0};
            double volume = 0;
            for (int other = 0; other < hair.groom.rest.count; ++other)
                for (int k = 0; k < count; ++k) {
                    const Asked& there = all[size_t(other)][size_t(k)];
                    const double w = weight(own.x, there.x);
                    volume += w * there.volume;
                    if (other != s) pull += (w * there.wet) * (there.x - own.x);
                }
            const Vec3d expected = (0.9 * cell / volume) * pull,
                        by = cast<double>(found.at(s, at(s, j)) - hair.groom.rest.at(s, at(s, j)));
            EXPECT_LT(norm(by - expected), 2e-6) << s << " " << j;
            most = std::max(most, norm(expected));
        }
    EXPECT_GT(most, 2e-3);  // [m]
    // What lies between moves linearly.
    const Vec3f a = found.at(3, at(3, 1)) - hair.groom.rest.at(3, at(3, 1)),
                b = found.at(3, at(3, 2)) - hair.groom.rest.at(3, at(3, 2)),
                between = found.at(3, at(3, 1) + 1) - hair.groom.rest.at(3, at(3, 1) + 1);
    EXPECT_LT(norm(between - (1 - 1.f / every) * a - (1.f / every) * b), 1e-6f);
}

TEST(LockGrid, bring_strands_together_and_leave_roots_and_lengths) {
    Hair hair;
    std::fill(hair.saturation.begin(), hair.saturation.end(), 1.f);
    LockTerms asked = terms(0.02f, {0.97f, 0.97f, 0.97f});
    asked.coherence = 0.01f, asked.stretch = 0.05f;
    const Strands found = hair.drawn(asked);
    EXPECT_LT(Hair::spread(found), 0.5 * Hair::spread(hair.groom.rest));
    for (int s = 0; s < found.count; ++s) {
        EXPECT_EQ(norm(found.at(s, 0) - hair.groom.rest.at(s, 0)), 0);
        for (int i = 1; i < found.particles; ++i)
            EXPECT_LT(norm(found.at(s, i) - found.at(s, i - 1)),
                      1.0501f * hair.edges[size_t(s * found.particles + i)]);
    }
}

TEST(LockGrid, of_dry_hair_and_beyond_reach_are_none) {
    Hair dry;
    std::fill(dry.saturation.begin(), dry.saturation.end(), 0.f);
    EXPECT_LT(largest_distance(dry.drawn(terms()), dry.groom.rest), 1e-6);
    const Hair apart({.width = 5, .height = 4, .particles = 33, .radius = 0.001, .spacing = 0.012});
    EXPECT_LT(largest_distance(apart.drawn(terms(0.005f)), apart.groom.rest), 1e-6);
}

TEST(LockGrid, turn_with_the_head) {
    const Hair hair;
    LockTerms asked = terms(0.02f, {1.2f, 0.8f});
    asked.coherence = 0.01f;
    const Pose pose = some_pose(4);
    const Strands still = hair.drawn(asked),
                  turned = hair.drawn(asked, {{moved(hair.groom.rest, pose), pose}});
    EXPECT_LT(largest_distance(moved(still, pose), turned), 2e-5);
}

TEST(LockGrid, are_the_mean_over_frames) {
    const Hair hair;
    const Strands other = curly_groom({.width = 7, .height = 5, .particles = 33}, 2).rest;
    LockTerms asked = terms();
    const Strands now = hair.drawn(asked, {{other, Pose()}}), before = hair.drawn(asked);
    asked.frames = 2;
    const Strands both = hair.drawn(asked, {{hair.groom.rest, Pose()}, {other, Pose()}}),
                  first = hair.drawn(asked);
    EXPECT_LT(largest_distance(first, before), 1e-6);
    for (size_t k = 0; k < now.points.size(); ++k) {
        const Vec3f mean =
            0.5f * (now.points[k] - other.points[k] + before.points[k] - hair.groom.rest.points[k]);
        ASSERT_LT(norm(both.points[k] - other.points[k] - mean), 2e-6f) << k;
    }
}

TEST(LockGrid, are_the_same_bits_by_any_number_of_threads) {
    const Hair hair;
    const auto [one, three] = testing::with_one_and_three_threads([&] {
        return hair.drawn(terms(0.02f, {1.3f, 0.8f, 0.9f}));
    });
    EXPECT_EQ(largest_distance(one, three), 0);
}

TEST(LockGrid, holds_particles_whose_cell_is_rounded_up) {
    // As 99.99999 + 100 is 200 in single precision: the cell above that of 99.99999.
    const Hair hair;
    const LockTerms asked = terms();
    const float cell = std::sqrt(0.225f) * asked.reach;
    const int tip = hair.groom.rest.particles - 1;
    Strands wide = hair.groom.rest;
    wide.at(0, tip) = {-0.29f, -0.29f, -0.29f};
    for (int s = 1; s < 12; ++s) {
        const float below = std::nextafter(cell * std::floor(0.29f / cell), 0.f) - 1e-9f * float(s);
        wide.at(s, tip) = {below, below, below};
    }
    const Strands found = hair.drawn(asked, {{wide, Pose()}});
    for (const Vec3f& x : found.points) ASSERT_TRUE(std::isfinite(x.x + x.y + x.z));
}

TEST(LockGrid, of_strands_far_away_end_in_no_memory_that_is_not_there) {
    const Hair hair;
    Strands torn = hair.groom.rest;
    torn.at(3, 20) = {1e20f, -3, 2}, torn.at(5, 32) = {0, std::numeric_limits<float>::quiet_NaN(), 0};
    const Strands found = hair.drawn(terms(), {{torn, Pose()}});
    EXPECT_TRUE(std::isfinite(found.at(0, 32).x));
}

TEST(LockGrid, refuse_what_does_not_fit) {
    Hair hair;
    expect_error([&] { hair.drawn(terms(0)); }, {"locks", "reach of Eq 10"});
    expect_error([&] { hair.drawn(terms(0.02f, {})); }, {"locks", "0 sweeps"});
    expect_error([&] { hair.drawn(terms(1e-4f)); }, {"locks", "0.000100 m", "allowed are"});
    hair.saturation.pop_back();
    expect_error([&] { hair.drawn(terms()); }, {"locks", "saturations", "one each a particle"});
}

}  // namespace
}  // namespace wetcurl
