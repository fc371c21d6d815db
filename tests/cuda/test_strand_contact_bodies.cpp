// The device's contact between strands run on the host, particle by particle, against the reference pass.
#include <gtest/gtest.h>

#include "cuda/strand_contact/strand_contact_kernel_body.h"
#include "solver/strand_contact/strand_contact_pass.h"
#include "tests/cuda/host_search.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;

constexpr double dt = 1.0 / 240;
constexpr StrandContact term{0.004, 20, 5};

// Strands that have come into one place, some drawn in it; with unequal masses.
template <class T>
struct Tangle {
    Strands drawn, x;
    std::vector<Vec3<T>> v, v_before;
    std::vector<T> mass;
    Tangle(int count, int particles, unsigned seed) : drawn(count, particles), x(drawn) {
        Random random(seed);
        for (size_t k = 0; k < x.points.size(); ++k) {
            drawn.points[k] = k % 3 == 0 ? cast<float>(random.vector(0.005)) : Vec3f{float(k), 0, 0};
            x.points[k] = Vec3f{1, 2, 0} + cast<float>(random.vector(0.006));
            v.push_back(cast<T>(random.vector(0.5))), v_before.push_back(cast<T>(random.vector(0.5)));
            mass.push_back(T(random.number(1e-8, 8e-8)));
        }
    }
    // What velocities change by, as the pass has it.
    std::vector<Vec3f> by_reference() const {
        StrandContactPass pass(term, drawn);
        pass.x = x;
        for (size_t k = 0; k < v.size(); ++k) {
            pass.v.points[k] = cast<float>(v[k]);
            pass.inverse_mass[k] = int(k) % x.particles < 2 ? 0.f : 1 / float(mass[k]);
        }
        pass.resolve(dt);
        return pass.v.points;
    }
    // The same, done to the velocities. Returns how many pairs are near.
    size_t push() {
        const HostSearch search(x.points, x.particles, strand_contact_radius(term), {1, 2, 0});
        std::vector<StrandContactPoint> point(v.size(), {NAN, NAN, NAN, NAN});
        std::vector<float> contacts(v.size(), NAN);
        StrandMemory<T> memory{};
        memory.n = x.particles, memory.strands = x.count;
        memory.v = v.data(), memory.v_before = v_before.data(), memory.mass = mass.data();
        const StrandContactKernelBody<T> b{term,         StrandContact::Step(term, dt),
                                           search.view,  drawn.points.data(),
                                           point.data(), contacts.data()};
        size_t near = 0;
        // Backwards: a pass reads nothing that it writes for another.
        for (uint32_t k = b.search.count; k-- > 0;) near += b.count(k, memory);
        for (uint32_t k = b.search.count; k-- > 0;) b.push(k, memory);
        return near;
    }
};

template <class T>
void expect_the_references(Tangle<T> t, const std::vector<Vec3f>& wanted) {
    const auto v = t.v, v_before = t.v_before;
    EXPECT_GT(t.push(), t.v.size());
    float most = 0;
    for (size_t k = 0; k < v.size(); ++k) {
        most = std::max(most, norm(wanted[k]));
        // Sums of a hundred pairs in single precision, in another order.
        EXPECT_LT(norm(cast<float>(t.v[k] - v[k]) - wanted[k]), 2e-6f) << k;
        EXPECT_LT(norm(cast<float>(t.v_before[k] - v_before[k]) - wanted[k]), 2e-6f) << k;
        if (int(k) % t.x.particles < 2) {
            EXPECT_EQ(norm(t.v[k] - v[k]), 0) << k;
        }
    }
    EXPECT_GT(most, 0.1);
}

TEST(StrandContactKernelBody, do_what_the_reference_pass_does) {
    for (int particles : {3, 20}) {
        const Tangle<float> single(12, particles, unsigned(particles));
        expect_the_references(single, single.by_reference());
        const Tangle<double> twofold(12, particles, unsigned(particles));
        expect_the_references(twofold, twofold.by_reference());
    }
}

TEST(StrandContactKernelBody, leave_what_is_not_finite) {
    Tangle<double> t(12, 20, 9);
    // The reference has them where they meet nobody.
    for (int s = 1; s < 4; ++s) t.x.at(s, 7) = {1, 2, float(s)};
    const auto wanted = t.by_reference();
    t.x.at(1, 7) = {NAN, 2, 0}, t.x.at(2, 7) = {1, INFINITY, 0}, t.x.at(3, 7) = {1e30f, 0, 0};
    expect_the_references(t, wanted);
}

}  // namespace
}  // namespace wetcurl
