// The device's contact between strands run on the host, particle by particle, against the reference.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <utility>

#include "cuda/strand_contact/strand_contact_kernel_body.h"
#include "solver/strand_contact/strand_links.h"
#include "tests/cuda/host_search.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;

constexpr double dt = 1.0 / 240;

// Strands that have come into one place, some drawn in it; with unequal masses. `edge`: of the groom, which
// says how many places a particle has.
template <class T>
struct Tangle {
    const StrandContact term{0.004, 1e4, 0.3, 4};
    const double edge;
    Strands drawn;
    std::vector<Vec3<T>> x, x_before, v, v_before;
    std::vector<T> mass, saturation;
    const Bdf2<T> scheme{T(dt), false};
    Tangle(int count, int particles, double edge, unsigned seed) : edge(edge), drawn(count, particles) {
        Random random(seed);
        for (size_t k = 0; k < drawn.points.size(); ++k) {
            drawn.points[k] = k % 3 == 0 ? cast<float>(random.vector(0.005)) : Vec3f{float(k), 0, 0};
            x.push_back(Vec3<T>{1, 2, 0} + cast<T>(random.vector(0.006)));
            v.push_back(cast<T>(random.vector(0.1))), v_before.push_back(cast<T>(random.vector(0.1)));
            x_before.push_back(x.back() - T(dt) * v.back());
            mass.push_back(T(random.number(1e-8, 8e-8))), saturation.push_back(T(random.number(0, 1)));
        }
    }
    uint32_t count() const { return uint32_t(x.size()); }
    // All come nearer to the middle.
    void press() {
        for (auto* points : {&x, &x_before})
            for (auto& p : *points) p = Vec3<T>{1, 2, 0} + T(0.8) * (p - Vec3<T>{1, 2, 0});
    }
};

template <class T>
struct Reference {
    StrandLinks links;
    explicit Reference(const Tangle<T>& t) : links(t.term, t.drawn, t.edge) { see(t); }
    void see(const Tangle<T>& t) {
        auto expected = [&](size_t k) { return t.scheme.predicted(t.x[k], t.x_before[k], t.v[k]); };
        for (size_t k = 0; k < t.x.size(); ++k) {
            links.particles[k] = {cast<float>(expected(k) - expected(0)), float(t.mass[k]),
                                  cast<float>(t.v[k]), float(t.saturation[k])};
        }
    }
};

template <class T>
struct Device {
    std::vector<LinkedParticle> particles;
    std::vector<Vec3f> x;
    std::vector<Vec3<T>> force;
    std::vector<T> stiffness;
    std::vector<StrandLink> links, found;
    std::vector<PlaceOnStrand> other;
    std::vector<LinkForce> link_force;
    std::vector<uint32_t> rank, begin, leading;
    StrandMemory<T> memory{};
    StrandContactKernelBody<T> b;
    explicit Device(Tangle<T>& t)
        : particles(t.count(), {{NAN, NAN, NAN}, NAN, {NAN, NAN, NAN}, NAN}),
          x(t.count(), {NAN, NAN, NAN}),
          force(t.count(), {T(NAN), T(NAN), T(NAN)}),
          stiffness(t.count(), T(NAN)),
          links(places_of(t) * most_links),
          found(links),
          other(links.size()),
          link_force(links.size()),
          rank(links.size()),
          begin(size_t(t.drawn.count) + 1),
          leading(links.size()),
          b{.term = t.term,
            .step = StrandContact::Step(t.term, dt),
            .places = {uint32_t(t.drawn.particles), t.term.places(t.edge, t.drawn.particles)},
            .reach = float(t.term.reach(t.edge)),
            .search = {},
            .drawn = t.drawn.points.data(),
            .particles = particles.data(),
            .x = x.data(),
            .links = links.data(),
            .found = found.data(),
            .other = other.data(),
            .force = link_force.data(),
            .rank = rank.data(),
            .begin = begin.data(),
            .leading = leading.data()} {
        memory.n = t.drawn.particles, memory.strands = t.drawn.count;
        memory.x = t.x.data(), memory.x_before = t.x_before.data();
        memory.v = t.v.data(), memory.v_before = t.v_before.data();
        memory.mass = t.mass.data(), memory.saturation = t.saturation.data();
        b.search.count = t.count();
    }
    static size_t places_of(const Tangle<T>& t) {
        return size_t(t.drawn.count) * t.term.places(t.edge, t.drawn.particles);
    }
    std::vector<ContactSum> sums() const {
        std::vector<ContactSum> sum(particles.size());
        for (uint32_t s = b.strand_count(); s-- > 0;)
            for (uint32_t k = b.acts_on(s); k-- > 0;)
                b.add_up(s, k, [&](uint32_t particle, const ContactSum& more) {
                    ContactSum& to = sum[s * b.places.n + particle];
                    to.x += more.x, to.y += more.y, to.z += more.z, to.stiffness += more.stiffness;
                });
        return sum;
    }
    // Backwards: a pass reads nothing that it writes for another. Returns how many links are found. `side`:
    // of the search's cells [m].
    size_t evaluate(const Tangle<T>& t, bool finds, double side) {
        for (uint32_t id = t.count(); id-- > 0;) b.see(id, memory, t.scheme, finds);
        size_t all = 0;
        if (finds) {
            const HostSearch search(x, t.drawn.particles, side, {0, 0, 0});
            b.search = search.view;
            for (uint32_t k = t.count(); k-- > 0;) all += b.link(k);
            for (uint32_t l = b.link_count(); l-- > 0;)
                b.count_link(
                    l, [](uint32_t& shared, uint32_t more) { return std::exchange(shared, shared + more); });
            std::exclusive_scan(begin.begin(), begin.end(), begin.begin(), 0u);
            for (uint32_t l = b.link_count(); l-- > 0;) b.list_link(l);
        }
        for (uint32_t l = b.link_count(); l-- > 0;) b.act(l);
        const auto sum = sums();
        for (uint32_t id = t.count(); id-- > 0;) b.give(id, sum[id], false, force.data(), stiffness.data());
        return all;
    }
};

double largest(const std::vector<Vec3f>& a) {
    double most = 0;
    for (const auto& p : a) most = std::max(most, double(norm(p)));
    return most;
}

template <class T>
void expect_the_references(Tangle<T> t, double share) {
    Reference<T> reference(t);
    Device<T> device(t);
    auto compare = [&](bool finds) {
        if (finds) reference.links.find();
        reference.links.evaluate(dt);
        const size_t found = device.evaluate(t, finds, share * double(device.b.reach));
        if (finds) {
            EXPECT_EQ(found, size_t(std::lround(reference.links.neighbours_mean() *
                                                double(Device<T>::places_of(t)))));
            EXPECT_GT(found, Device<T>::places_of(t));
        }
        for (uint32_t l = 0; l < device.b.link_count(); ++l)
            EXPECT_EQ(device.b.links[l].other, reference.links.links()[l].other) << l;
        const double most = largest(reference.links.force());
        for (size_t k = 0; k < t.x.size(); ++k) {
            EXPECT_LT(double(norm(cast<float>(device.force[k]) - reference.links.force()[k])), 1e-5 * most)
                << k;
            EXPECT_NEAR(double(device.stiffness[k]), double(reference.links.stiffness()[k]),
                        1e-4 * double(reference.links.stiffness()[k]) + 1e-6);
        }
        return most;
    };
    compare(true);
    t.press(), reference.see(t);
    EXPECT_GT(compare(false), 0);
    EXPECT_GT(compare(true), 0);
    EXPECT_GT(*std::max_element(device.stiffness.begin(), device.stiffness.end()), T(0));

    std::vector<Vec3d> at;
    double energy = 0, wanted = 0;
    for (const auto& p : t.x) at.push_back(cast<double>(p));
    for (uint32_t l = 0; l < device.b.link_count(); ++l) energy += device.b.energy(l, device.memory);
    wanted = reference.links.potential(at);
    EXPECT_NEAR(energy, wanted, 1e-5 * std::abs(wanted));
}

TEST(StrandContactKernelBody, do_what_the_reference_does) {
    for (int particles : {4, 20})
        for (double edge : {0.003, 0.011}) {
            for (double share : {0.2, 1.0}) {
                expect_the_references(Tangle<float>(12, particles, edge, unsigned(particles)), share);
                expect_the_references(Tangle<double>(12, particles, edge, unsigned(particles)), share);
            }
        }
}

TEST(StrandContactKernelBody, leave_what_is_not_finite) {
    Tangle<double> t(12, 20, 0.003, 9);
    t.x[27] = {NAN, 2, 0}, t.x[47] = {1, INFINITY, 0}, t.x[67] = {1e30, 0, 0};
    Device<double> device(t);
    device.evaluate(t, true, double(device.b.reach));
    size_t finite = 0;
    for (const auto& f : device.force) finite += std::isfinite(f.x + f.y + f.z);
    EXPECT_EQ(finite, device.force.size());
}

TEST(ContactSum, holds_forces_to_single_precision_in_any_order) {
    for (float a : {1e-9f, -3e-5f, 0.1f, -12.f, 0.f}) {
        ContactSum sum{};
        for (int k = 0; k < 3; ++k) sum.x += ContactSum::of({a, 0, 0}, 0).x;
        EXPECT_NEAR(double(sum.force().x), 3 * double(a), 3e-7 * std::abs(double(a)));
    }
    const ContactSum most = ContactSum::of({0, -1e20f, NAN}, 0);
    EXPECT_LT(double(most.force().y), -900);
    EXPECT_EQ(most.force().z, 0);
}

}  // namespace
}  // namespace wetcurl
