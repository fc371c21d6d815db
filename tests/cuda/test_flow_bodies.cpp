// The device's flow of water run on the host, thread by thread, against the pass.
#include <gtest/gtest.h>

#include <algorithm>

#include "base/strided.h"
#include "solver/water/flow_pass.h"
#include "tests/base/scratch.h"
#include "tests/cuda/host_search.h"

namespace wetcurl {
namespace {

using namespace testing;

constexpr double density = 6.5e-6, absorbed = 0.3, dt = 1.0 / 24;  // [kg/m], m_absorbed, [s]
const Vec3d gravity{0, -9.81, 0};

// Strands down from a disc, near each other, wet here and there and dry elsewhere.
struct Wisp {
    Strands p;
    std::vector<float> saturation;
    Wisp(int count, int particles) : p(count, particles) {
        Random random(5);
        for (int s = 0; s < count; ++s) {
            const Vec3d root{1 + random.number(-0.004, 0.004), 2, random.number(-0.004, 0.004)};
            for (int i = 0; i < particles; ++i) {
                p.at(s, i) = cast<float>(root + Vec3d{0, -0.002 * i, 0} + random.vector(0.0008));
                saturation.push_back(float(std::max(0.0, random.number(-0.5, 1))));
            }
        }
    }
};

Flow flow_over(double bottom) {
    Flow flow{};
    flow.K = 0.05, flow.H = 0.05, flow.dripping = 0.8, flow.drying = 0.3, flow.exchange = 8;
    flow.reach = 0.003;
    WaterSource pool{}, spray{};
    pool.rate = 4, pool.until = 10, pool.shape = Plane{}, pool.center = {0, bottom, 0};
    spray.rate = 2, spray.from = 1.5 * dt, spray.until = 2.5 * dt, spray.shape = Sphere{0.01};
    spray.center = {1, 1.99, 0};
    flow.sources = {pool, spray};
    return flow;
}

// FlowDevice on the host: its buffers, and its kernels in their order.
struct ByBodies {
    FlowHair hair;
    std::vector<double> sigma, next, limit;
    std::vector<FlowLedger> ledger;
    std::vector<FlowRow> rows;
    double contacts = 0;

    explicit ByBodies(const Wisp& wisp)
        : hair(wisp.p, density),
          sigma(wisp.saturation.begin(), wisp.saturation.end()),
          next(sigma.size()),
          limit(sigma.size()),
          ledger(size_t(wisp.p.count)),
          rows(sigma.size()) {}
    void step(const Flow& flow, const Strands& p, double time) {
        const FlowKernelBody b{flow,         density,     p.particles,  hair.mass.data(), hair.length.data(),
                               sigma.data(), next.data(), limit.data(), ledger.data()};
        const size_t strands = size_t(p.count);
        for (size_t s = 0; s < strands; ++s) {
            for (const auto& source : flow.sources)
                if (const auto now = source.over(time, dt); now.taken > 0)
                    b.wet(int(s), now, p.points.data());
            b.run_along(int(s), p.points.data(), dt, flow.down(gravity),
                        Strided<FlowRow>{rows.data() + s, strands});
        }
        const HostSearch search(p.points, p.particles, flow.reach, {1, 2, 0});
        // Backwards: no thread waits for another.
        for (uint32_t k = uint32_t(sigma.size()); k-- > 0;) {
            const SortedPoint own = search.sorted[k];
            b.find_limit(own.id, dt, [&](auto visit) { search.view.contacts(own, visit); });
            search.view.contacts(own, [&](size_t, double) { contacts += 1; });
        }
        for (uint32_t k = uint32_t(sigma.size()); k-- > 0;) {
            const SortedPoint own = search.sorted[k];
            b.pass_on(own.id, dt, [&](auto visit) { search.view.contacts(own, visit); });
        }
        for (int s = 0; s < p.count; ++s) b.shed_excess(s, b.next), b.dry(s, flow.dried(dt));
    }
    WaterBalance water(double start) const {
        return water_balance(absorbed, start, water_held(hair.mass.data(), sigma.data(), sigma.size()),
                             ledger);
    }
};

TEST(FlowKernelBody, do_what_the_pass_does) {
    for (int particles : {2, 20, 33}) {
        SCOPED_TRACE(particles);
        const Wisp wisp(24, particles);
        const Flow flow = flow_over(2 - 0.0015 * particles);
        FlowPass pass(flow, FlowHair(wisp.p, density), absorbed, wisp.saturation);
        ByBodies bodies(wisp);
        const double start = water_held(bodies.hair.mass.data(), bodies.sigma.data(), bodies.sigma.size());
        for (int k = 0; k < 4; ++k) {
            pass.step(wisp.p, k * dt, dt, gravity);
            bodies.step(flow, wisp.p, k * dt);
        }
        double most = 0, moved = 0;
        for (size_t k = 0; k < bodies.sigma.size(); ++k) {
            most = std::max(most, std::abs(bodies.sigma[k] - pass.exact()[k]));
            moved = std::max(moved, std::abs(bodies.sigma[k] - double(wisp.saturation[k])));
        }
        EXPECT_GT(moved, 0.1);
        EXPECT_GT(bodies.contacts, 8.0 * double(bodies.sigma.size()));
        // Sums in another order, and distances are floats.
        EXPECT_LT(most, 1e-7);
        const WaterBalance got = bodies.water(start), wanted = pass.water();
        for (auto part : {&WaterBalance::start, &WaterBalance::held, &WaterBalance::taken,
                          &WaterBalance::dripped, &WaterBalance::dried}) {
            EXPECT_GT(wanted.*part, 1e-3 * wanted.start);
            EXPECT_NEAR(got.*part, wanted.*part, 1e-7 * wanted.start);
        }
        EXPECT_LE(std::abs(got.balance()), 1e-13 * (got.start + got.taken));
    }
}

TEST(FlowKernelBody, who_is_too_far_for_a_cell_touches_nobody) {
    Wisp wisp(6, 12);
    Flow flow = flow_over(0);
    flow.K = 0, flow.sources.clear();
    for (int i = 0; i < 12; ++i) wisp.p.at(2, i) = {1e30f, 0, 0};
    ByBodies bodies(wisp);
    bodies.step(flow, wisp.p, 0);
    const double left = 1 - flow.dried(dt);
    for (int i = 0; i < 12; ++i)
        EXPECT_NEAR(bodies.sigma[24 + size_t(i)], wisp.saturation[24 + size_t(i)] * left, 1e-15) << i;
    EXPECT_GT(bodies.contacts, 0);
}

}  // namespace
}  // namespace wetcurl
