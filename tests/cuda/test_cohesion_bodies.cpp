// The device's cohesion run on the host, block by block, against the reference pass.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <memory>

#include "cuda/cohesion/cohesion_lists.h"
#include "solver/cohesion/cohesion_pass.h"
#include "tests/base/scratch.h"
#include "tests/cuda/host_search.h"
#include "tests/cuda/host_team.h"

namespace wetcurl {
namespace {

using namespace testing;

// Strands down from a disc, near each other, far from the origin, with unequal volumes and saturations.
struct Tuft {
    Strands p;
    std::vector<float> volume, saturation;
    Tuft(int count, int particles, unsigned seed) : p(count, particles) {
        Random random(seed);
        for (int s = 0; s < count; ++s) {
            const Vec3d root{1 + random.number(-0.01, 0.01), 2, random.number(-0.01, 0.01)};
            for (int i = 0; i < particles; ++i)
                p.at(s, i) = cast<float>(root + Vec3d{0, -0.002 * i, 0} + random.vector(0.001));
        }
        for (size_t k = 0; k < p.points.size(); ++k) {
            volume.push_back(float(random.number(0.5e-10, 2e-10)));
            saturation.push_back(float(random.number(0, 1)));
        }
    }
};

struct Result {
    Strands displayed;
    double neighbours_mean;
    uint32_t longest;  // rows of the lists
};

Result by_reference(const Tuft& hair, const Cohesion& term) {
    CohesionPass pass(term, hair.p.count, Thinning(hair.p, term), hair.volume, hair.saturation);
    Strands out = hair.p;
    pass.apply(out);
    return {out, pass.neighbours_mean(), 0};
}

template <class Who = OneAlone>
Result by_bodies(const Tuft& hair, const Cohesion& term, Who who = {}, int staged = 48) {
    const Thinning thinning(hair.p, term);
    const int n = thinning.count;
    const ThinnedWater water(thinning, hair.volume, hair.saturation);
    Strands asked(hair.p.count, n);
    for (int s = 0; s < asked.count; ++s)
        for (int j = 0; j < n; ++j) asked.at(s, j) = hair.p.at(s, thinning.at(s, j));
    const std::vector<Vec3f>& simulated = asked.points;
    const uint32_t count = uint32_t(simulated.size());
    std::vector<HairPoint> point(count + 1);
    std::vector<float> wet_volume(count), sorted_wet_volume(count + 1);
    const bool some_dry = thinning.seen < 1 || std::ranges::count(hair.saturation, 0.f) > 0;
    const uint32_t blocks = (count + list_block - 1) / list_block, places = blocks * list_block;
    std::vector<ListGroup> group(places / ListGroup::lanes);
    std::vector<uint8_t> lane_takes(places);
    std::vector<Displaced> displaced(count);
    std::vector<float> beta(size_t(hair.p.count)), weight(size_t(hair.p.count)), self_weight(count);
    const HostSearch search(simulated, n, term.h_c, {1, 2, 0});
    std::vector<uint8_t> wet_cell(search.view.grid.cells());
    CohesionKernelBody b{
        term,
        thinning,
        {search.view, point.data(), sorted_wet_volume.data(), some_dry ? wet_cell.data() : nullptr,
         group.data(), lane_takes.data(), nullptr, displaced.data(), beta.data(), weight.data(),
         !thinning.is_whole() ? water.own_volume.data() : nullptr, self_weight.data()}};
    for (int s = 0; s < hair.p.count; ++s)
        b.measure(s, arc_length(hair.p.strand(s), hair.p.particles), arc_length(asked.strand(s), n));
    for (uint32_t k = 0; k < count; ++k) wet_volume[k] = water.volume[k] * water.saturation[k];
    for (uint32_t k = 0; k < count; ++k) b.take(k, water.volume.data(), wet_volume.data());

    // Until there is room for them, as the device does.
    std::vector<Ranks<4>> list;
    double pairs = 0;
    const auto list_room = std::make_unique<ListRoom>();
    std::vector<uint32_t> near(ListRoom::near(staged));
    for (uint32_t rows = 1; ListGroup::lanes * size_t(rows) > list.size();) {
        list.resize(ListGroup::lanes * size_t(rows));
        b.m.list = list.data();
        const uint32_t capacity = rows;
        rows = 0, pairs = 0;
        auto reserve = [&](uint32_t more, unsigned of_block) {
            const uint32_t row = rows;
            rows += more, pairs += of_block;
            return rows <= capacity ? row : no_list;
        };
        for (uint32_t k = 0; k < blocks; ++k)
            as_a_team(who, [&]<class Barrier>(const ThreadTeam<Barrier>& team) {
                CohesionLists<Barrier>(b, team, k, near.data(), staged).build(*list_room, reserve);
            });
    }
    // Some strands at a time, the last alone; the first keep what they read, the others read it anew.
    const int of_block = 3, row = CohesionKernelBody::MoveWorkspace::numbers_a_strand(n);
    std::vector<float> by(size_t(3 * of_block * row));
    std::vector<HairPoint> from(size_t(of_block * n));
    std::vector<uint32_t> rank(from.size());
    for (int sweep = 0; sweep < term.sweeps(); ++sweep) {
        b.term = term.of_sweep(sweep);
        // Backwards: a pass reads no position that it writes.
        for (uint32_t place = places; place-- > 0;) b.displace(place, 0, [](float x) { return x; });
        for (int first = 0; first < hair.p.count; first += of_block)
            as_a_team(who, [&]<class Barrier>(const ThreadTeam<Barrier>& team) {
                b.move_strands(team, first, std::min(of_block, hair.p.count - first),
                               {by.data(), first % 2 == 0 ? from.data() : nullptr, rank.data()});
            });
    }
    Result out{hair.p, pairs / double(count), std::ranges::max(group, {}, &ListGroup::rows).rows};
    std::vector<ShownPoint> shown;
    std::vector<Vec3f> moved;
    moved.resize(size_t(n));
    for (int s = 0; s < hair.p.count; ++s) {
        for (int j = 0; j < n; ++j) moved[size_t(j)] = b.moved(s, j, hair.p.points.data());
        for (int i = 0; i < hair.p.particles; ++i)
            shown.push_back(b.shown(s, i, hair.p.points.data(), moved.data()));
    }
    for (size_t root = 0; root < shown.size(); root += size_t(hair.p.particles))
        b.within_lengths(&shown[root]);
    for (size_t id = 0; id < shown.size(); ++id) out.displayed.points[id] = shown[id].position();
    return out;
}

double farthest(const Strands& a, const Strands& b) {
    double most = 0;
    for (size_t k = 0; k < a.points.size(); ++k)
        most = std::max(most, double(norm(a.points[k] - b.points[k])));
    return most;
}

TEST(CohesionKernelBody, do_what_the_reference_pass_does) {
    for (int particles : {2, 20, 33, 100})
        for (double coherence : {0.0, 0.015}) {
            Cohesion term{0.004, 0.85, coherence, 0.05, 0};
            term.passes = 3;
            const Tuft hair(40, particles, unsigned(particles));
            const Result wanted = by_reference(hair, term), got = by_bodies(hair, term);
            ASSERT_GT(farthest(wanted.displayed, hair.p), 2e-5);
            EXPECT_GT(got.neighbours_mean, 2);
            EXPECT_NEAR(got.neighbours_mean, wanted.neighbours_mean, 1e-9);
            // Positions near 2 m have an ulp of 2.4e-7 m; three passes amplify it.
            EXPECT_LT(farthest(got.displayed, wanted.displayed), 3e-6) << particles << ' ' << coherence;
        }
}

TEST(CohesionKernelBody, do_so_where_some_particles_stand_for_others) {
    for (int particles : {3, 20, 33, 100}) {
        Cohesion term{0.004, 0.85, 0.015, 0.05, 0};
        const Tuft hair(40, particles, unsigned(particles));
        term.passes = 3, term.spacing = 2 * arc_length(hair.p.strand(0), particles) / (particles - 1);
        ASSERT_EQ(Thinning(hair.p, term).every, 2);
        const Result wanted = by_reference(hair, term), got = by_bodies(hair, term);
        ASSERT_GT(farthest(wanted.displayed, hair.p), 2e-5);
        EXPECT_NEAR(got.neighbours_mean, wanted.neighbours_mean, 1e-9);
        EXPECT_LT(farthest(got.displayed, wanted.displayed), 3e-6) << particles;
    }
}

TEST(CohesionKernelBody, do_so_where_some_strands_stand_for_all) {
    for (const int every : {1, 2}) {
        Cohesion term{0.012, 0.85, 0.015, 0.05, 0};
        const Tuft hair(60, 33, 7);
        const Result all = by_reference(hair, term);
        if (every > 1) term.spacing = every * arc_length(hair.p.strand(0), 33) / 32;
        term.passes = 3, term.neighbours = int(all.neighbours_mean / every / 3);
        const Thinning thinning(hair.p, term);
        ASSERT_EQ(thinning.every, every);
        ASSERT_GT(thinning.seen, 0.1);
        ASSERT_LT(thinning.seen, 0.6);
        const Result wanted = by_reference(hair, term), got = by_bodies(hair, term);
        ASSERT_GT(farthest(wanted.displayed, hair.p), 2e-5);
        EXPECT_NEAR(got.neighbours_mean, wanted.neighbours_mean, 1e-9);
        EXPECT_LT(got.neighbours_mean, 0.7 * all.neighbours_mean / every);
        EXPECT_LT(farthest(got.displayed, wanted.displayed), 3e-6) << every;
    }
}

TEST(CohesionKernelBody, do_so_in_over_relaxed_sweeps) {
    Cohesion term{0.004, 0.85, 0.015, 0.05, 0};
    term.passes = 10, term.relaxation = 2.5;
    ASSERT_EQ(term.sweeps(), 4);
    const Tuft hair(40, 33, 6);
    const Result wanted = by_reference(hair, term), got = by_bodies(hair, term);
    EXPECT_GT(farthest(wanted.displayed, by_reference(hair, Cohesion{0.004, 0.85, 0.015, 0.05, 0}).displayed),
              1e-5);
    EXPECT_LT(farthest(got.displayed, wanted.displayed), 1e-5);
}

TEST(CohesionKernelBody, do_the_same_as_many_threads) {
    const Cohesion term{0.004, 0.85, 0.015, 0.05, 0};
    for (const bool some_dry : {false, true}) {
        Tuft hair(40, 33, 5);
        for (size_t k = 0; some_dry && k < hair.saturation.size(); k += 3) hair.saturation[k] = 0;
        const Result alone = by_bodies(hair, term), many = by_bodies(hair, term, ManyThreads());
        ASSERT_GT(farthest(alone.displayed, hair.p), 2e-5);
        EXPECT_EQ(alone.neighbours_mean, many.neighbours_mean);
        EXPECT_EQ(farthest(alone.displayed, many.displayed), 0);
    }
}

// More neighbours than are kept when they are found, and more than have lengths of their own.
TEST(CohesionKernelBody, do_what_the_reference_pass_does_in_a_crowd) {
    for (double radius : {0.012, 0.4}) {
        Cohesion term{radius, 0.85, 0.0, unbounded, 0};
        term.passes = 2;
        const Tuft hair(50, 90, 2);
        const Result wanted = by_reference(hair, term), got = by_bodies(hair, term, ManyThreads(), 16);
        ASSERT_GT(farthest(wanted.displayed, hair.p), 2e-5);
        EXPECT_GT(got.longest, ListRoom::lengths);
        EXPECT_NEAR(got.neighbours_mean, wanted.neighbours_mean, 1e-9);
        EXPECT_LT(farthest(got.displayed, wanted.displayed), 3e-6) << radius;
    }
}

TEST(CohesionKernelBody, search_nothing_for_hair_that_meets_no_wet_one) {
    const Cohesion term{0.004, 0.85, 0.0, unbounded, 0};
    Tuft hair(40, 60, 3);
    const Result all_wet = by_bodies(hair, term);
    // Tips alone are wet, of every other strand: 0.118 m long, drawn to each other within 4 mm.
    for (int s = 0; s < 40; ++s)
        for (int i = 0; i < 60; ++i)
            if (s % 2 || i < 45) hair.saturation[size_t(60 * s + i)] = 0;
    const Result wanted = by_reference(hair, term), got = by_bodies(hair, term);
    EXPECT_GT(got.neighbours_mean, 0.2 * all_wet.neighbours_mean);
    EXPECT_LT(got.neighbours_mean, 0.4 * all_wet.neighbours_mean);
    EXPECT_NEAR(got.neighbours_mean, wanted.neighbours_mean, 1e-9);
    ASSERT_GT(farthest(wanted.displayed, hair.p), 2e-5);
    EXPECT_LT(farthest(got.displayed, wanted.displayed), 3e-6);
}

TEST(CohesionKernelBody, find_no_neighbour_for_what_is_not_finite) {
    Tuft hair(40, 20, 1);
    const Cohesion term{0.004, 0.85, 0.0, unbounded, 0};
    // The reference, whose grid has bounds, has them where they meet nobody.
    for (int s = 1; s < 4; ++s) hair.p.at(s, 7) = {1, 2, float(s)};
    const Result wanted = by_reference(hair, term);
    ASSERT_GT(farthest(wanted.displayed, hair.p), 2e-5);
    hair.p.at(1, 7) = {1e30f, 0, 0};
    hair.p.at(2, 7) = {NAN, 0, 0};
    hair.p.at(3, 7) = {INFINITY, 0, 0};
    const Result got = by_bodies(hair, term);
    EXPECT_TRUE(std::isnan(got.displayed.at(2, 7).x));
    EXPECT_NEAR(got.neighbours_mean, wanted.neighbours_mean, 1e-9);
    for (int s = 0; s < 40; ++s)
        for (int i = 0; i < 20; ++i) {
            // What is lost stays, and draws nobody along.
            if (s > 0 && s < 4 && i == 7)
                EXPECT_EQ(std::memcmp(&got.displayed.at(s, i), &hair.p.at(s, i), sizeof(Vec3f)), 0);
            else
                EXPECT_LT(norm(got.displayed.at(s, i) - wanted.displayed.at(s, i)), 3e-6) << s << ' ' << i;
        }
}

}  // namespace
}  // namespace wetcurl
