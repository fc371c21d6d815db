// The device's cohesion run on the host, particle by particle, against the reference pass.
#include <gtest/gtest.h>

#include <algorithm>

#include "cuda/cohesion_bodies.h"
#include "solver/passes/cohesion.h"
#include "tests/base/scratch.h"
#include "tests/cuda/host_search.h"

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
};

Result by_reference(const Tuft& hair, const Cohesion& term) {
    CohesionPass pass(term, hair.p.count, hair.p.particles, hair.volume, hair.saturation);
    Strands out = hair.p;
    pass.apply(out);
    return {out, pass.neighbours_mean()};
}

Result by_bodies(const Tuft& hair, const Cohesion& term) {
    const size_t count = hair.p.points.size();
    const int n = hair.p.particles, groups = (n + 31) / 32;
    std::vector<HairPoint> now(count + 1), next(count + 1);
    std::vector<float> beta(size_t(hair.p.count)), own(size_t(hair.p.count));
    std::vector<uint32_t> list;
    const HostSearch search(hair.p.points, n, term.h_c, {1, 2, 0});
    const CohesionBodies b{term,
                           {search.view, uint32_t(count), n, now.data(), next.data(), beta.data(), own.data(),
                            nullptr, nullptr, nullptr, nullptr}};
    for (size_t k = 0; k < count; ++k)
        b.place(uint32_t(k), hair.p.points[k], hair.volume[k], hair.volume[k] * hair.saturation[k]);
    for (int s = 0; s < hair.p.count; ++s) b.measure(s);

    // A list of 32 particles of a strand in step, as the device keeps it.
    constexpr uint32_t room = 512;
    double pairs = 0;
    list.resize(size_t(hair.p.count) * size_t(groups) * 32 * room, uint32_t(count));
    auto list_of = [&](uint32_t k) {
        const size_t strand = k / uint32_t(n), i = k % uint32_t(n);
        return list.data() + (strand * size_t(groups) + i / 32) * 32 * room + i % 32;
    };
    for (uint32_t k = 0; k < count; ++k) {
        uint32_t found = 0;
        b.neighbours(k, [&](uint32_t j) { list_of(k)[32 * found++] = j; });
        EXPECT_LE(found, room);
        pairs += found;
    }
    std::vector<float> u(3 * size_t(n)), ends(32);
    for (int pass = 0; pass < term.passes; ++pass) {
        for (int s = 0; s < hair.p.count; ++s) {
            const uint32_t first = uint32_t(s) * uint32_t(n);
            for (int i = 0; i < n; ++i) {
                Vec3f d{0, 0, 0};
                if (i > 0)
                    d = b.displacement(now.data(), first + uint32_t(i), list_of(first + uint32_t(i)), room);
                u[size_t(i)] = d.x, u[size_t(n + i)] = d.y, u[size_t(2 * n + i)] = d.z;
            }
            if (term.coherence > 0)
                for (int axis = 0; axis < 3; ++axis)
                    smooth_along(u.data() + axis * n, n, beta[size_t(s)], ends.data(), [](auto body) {
                        for (int lane = 0; lane < 32; ++lane) body(lane);
                    });
            for (int i = 0; i < n; ++i) {
                HairPoint p = now[first + uint32_t(i)];
                p.x += u[size_t(i)], p.y += u[size_t(n + i)], p.z += u[size_t(2 * n + i)];
                next[first + uint32_t(i)] = p;
            }
        }
        std::swap(now, next);
    }
    Result out{hair.p, pairs / double(count)};
    for (int s = 0; s < hair.p.count; ++s)
        b.within_lengths(s, now.data(), hair.p.points.data(),
                         [&](uint32_t k, const Vec3f& x) { out.displayed.points[k] = x; });
    return out;
}

double farthest(const Strands& a, const Strands& b) {
    double most = 0;
    for (size_t k = 0; k < a.points.size(); ++k)
        most = std::max(most, double(norm(a.points[k] - b.points[k])));
    return most;
}

TEST(CohesionBodies, do_what_the_reference_pass_does) {
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

TEST(CohesionBodies, find_no_neighbour_for_what_is_not_finite) {
    Tuft hair(4, 20, 1);
    hair.p.at(2, 7) = {NAN, 0, 0};
    hair.p.at(3, 7) = {INFINITY, 0, 0};
    hair.p.at(1, 7) = {1e30f, 0, 0};
    const Result got = by_bodies(hair, Cohesion{0.004, 0.85, 0.0, unbounded, 0});
    EXPECT_TRUE(std::isnan(got.displayed.at(2, 7).x));
    EXPECT_TRUE(std::isfinite(got.displayed.at(0, 7).x));
}

}  // namespace
}  // namespace wetcurl
