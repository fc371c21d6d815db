// Contact between strands: momentum, energy and distances of the pass, and hair that keeps its volume.
#include <algorithm>
#include <cmath>

#include "solver/chain/scene_checks.h"
#include "solver/strand_contact/strand_contact_pass.h"
#include "tests/base/threads.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;

constexpr double dt = 1.0 / 240, radius = 0.004;

// Strands drawn far apart that have come into one place, with unequal masses.
struct Tangle {
    Strands rest, x, v;
    std::vector<float> inverse_mass;
    Tangle(int count, int particles, unsigned seed) : rest(count, particles), x(rest), v(rest) {
        Random random(seed);
        for (size_t k = 0; k < rest.points.size(); ++k) {
            rest.points[k] = {float(k), 0, 0};
            x.points[k] = cast<float>(random.vector(0.006)), v.points[k] = cast<float>(random.vector(0.5));
            inverse_mass.push_back(float(1 / random.number(1e-8, 8e-8)));
        }
    }
    // What the velocities change by.
    Strands changes(const StrandContact& term) const {
        StrandContactPass pass(term, rest);
        pass.inverse_mass = inverse_mass, pass.x = x, pass.v = v;
        pass.resolve(dt);
        return pass.v;
    }
    double kinetic(const Strands& dv) const {
        double sum = 0;
        for (size_t k = 0; k < v.points.size(); ++k) {
            const Vec3d w = cast<double>(v.points[k]) + cast<double>(dv.points[k]);
            sum += 0.5 * dot(w, w) / double(inverse_mass[k]);
        }
        return sum;
    }
};

double largest(const Strands& a) {
    double most = 0;
    for (const auto& p : a.points) most = std::max(most, double(norm(p)));
    return most;
}

TEST(StrandContact, keeps_the_momentum_of_the_hair) {
    const Tangle t(12, 20, 1);
    const Strands dv = t.changes({radius, 20, 5});
    Vec3d sum{0, 0, 0};
    double total = 0;
    for (size_t k = 0; k < dv.points.size(); ++k) {
        const Vec3d p = (1 / double(t.inverse_mass[k])) * cast<double>(dv.points[k]);
        sum += p, total += norm(p);
    }
    EXPECT_GT(largest(dv), 0.1);
    EXPECT_LT(norm(sum), 1e-6 * total);  // rounding of single precision
}

TEST(StrandContact, takes_kinetic_energy_at_any_friction_where_nothing_is_parted) {
    const Strands none(12, 20);
    for (unsigned seed : {2u, 3u, 4u})
        for (double friction : {0.0, 5.0, 1e3, 1e9}) {
            const Tangle t(12, 20, seed);
            const double share = t.kinetic(t.changes({radius, 0, friction})) / t.kinetic(none);
            EXPECT_LT(share, 0.999) << friction;
            EXPECT_GT(share, 0) << friction;
        }
}

TEST(StrandContact, parts_no_pair_faster_than_strength_times_radius) {
    Tangle t(2, 1, 5);
    t.inverse_mass = {3e7f, 9e7f};
    t.v = Strands(2, 1);
    t.x.points = {{0, 0, 0}, {0.001f, 0, 0}};
    const StrandContact term{radius, 20, 5};
    const Strands dv = t.changes(term);
    const double parting = double(dv.points[1].x - dv.points[0].x);
    EXPECT_NEAR(parting, -std::expm1(-20 * dt) / dt * 0.003, 1e-6);
    EXPECT_LT(parting, 20 * radius);
    // What parts by itself is left alone, and so are two in one place.
    t.v.points[1] = {1, 0, 0};
    EXPECT_EQ(largest(t.changes(term)), 0);
    t.x.points[1] = t.x.points[0], t.v.points[1] = {0, 0, 0};
    EXPECT_EQ(largest(t.changes(term)), 0);
}

TEST(StrandContact, leaves_the_groom_as_drawn_and_held_particles) {
    Tangle t(12, 20, 6);
    t.v = Strands(12, 20), t.rest = t.x;
    EXPECT_LT(largest(t.changes({radius, 20, 5})), 1e-6);
    Tangle held(12, 20, 7);
    std::fill(held.inverse_mass.begin(), held.inverse_mass.end(), 0.f);
    EXPECT_EQ(largest(held.changes({radius, 20, 5})), 0);
}

TEST(StrandContact, two_strands_pressed_together_keep_their_distance) {
    // In a field of a from both sides, which brings them nearer by 2 a dt² a step: the pass stops that whole
    // where each particle touches one other.
    constexpr int n = 20;
    constexpr float a = 9.81f;
    Tangle t(2, n, 8);
    for (int i = 0; i < n; ++i) {
        t.x.at(0, i) = {-0.004f, -0.005f * float(i), 0}, t.x.at(1, i) = {0.004f, -0.005f * float(i), 0};
        t.v.at(0, i) = t.v.at(1, i) = {0, 0, 0};
    }
    StrandContactPass pass({radius, 20, 5}, t.rest);
    pass.inverse_mass = t.inverse_mass;
    std::fill(pass.inverse_mass.begin(), pass.inverse_mass.end(), 3e7f);
    double low = 1, high = 0;
    for (int step = 0; step < 480; ++step) {
        for (int i = 0; i < n; ++i) t.v.at(0, i).x += a * float(dt), t.v.at(1, i).x -= a * float(dt);
        pass.x = t.x, pass.v = t.v;
        pass.resolve(dt);
        for (size_t k = 0; k < t.x.points.size(); ++k)
            t.v.points[k] += pass.v.points[k], t.x.points[k] += float(dt) * t.v.points[k];
        if (step < 240) continue;
        const double gap = double(t.x.at(1, n / 2).x - t.x.at(0, n / 2).x);
        low = std::min(low, gap), high = std::max(high, gap);
    }
    std::printf("two strands pressed by g from both sides: %.3f to %.3f mm apart, radius %.3f mm\n",
                1e3 * low, 1e3 * high, 1e3 * radius);
    EXPECT_GT(low, radius - 2 * 9.81 * dt * dt - 1e-6);
    EXPECT_LT(high, radius + 1e-6);
}

TEST(StrandContact, gives_the_same_bits_for_one_and_three_threads) {
    const Tangle t(40, 60, 9);
    const auto [one, three] = with_one_and_three_threads([&] { return t.changes({radius, 20, 5}); });
    EXPECT_GT(largest(one), 0.1);
    EXPECT_TRUE(same_bits(one, three));
}

TEST(StrandContact, lists_hold_every_pair_while_strands_move) {
    Tangle t(12, 20, 10);
    const StrandContact term{radius, 20, 5};
    StrandContactPass pass(term, t.rest);
    pass.inverse_mass = t.inverse_mass;
    for (int step = 0; step < 20; ++step) {
        pass.x = t.x, pass.v = t.v;
        pass.resolve(dt);
        const Strands anew = t.changes(term);
        for (size_t k = 0; k < anew.points.size(); ++k)  // sums in another order
            EXPECT_LT(norm(pass.v.points[k] - anew.points[k]), 1e-5) << step;
        for (size_t k = 0; k < t.x.points.size(); ++k) t.x.points[k] += 0.0005f * t.v.points[k];
    }
    EXPECT_LT(pass.lists_built(), 15);
    EXPECT_GT(pass.lists_built(), 1);
}

// --- in whole simulations

const std::string shaken = R"(fps = 24
[groom]
grid = [20, 20]
particles = 30
length = 0.15
scalp_radius = 0.05
lift = 0.01
[integrator]
settle = 0.5
[motion]
axis = [0, 0, 1]
angle = 60
period = 0.8
[stretch]
[bend]
[core]
[stiffness]
)";

// Of the outer two thirds of strands: the share of particles that another strand's has come to within half
// the radius of, from beyond it in the groom as drawn. Hair that kept its volume has none.
double crowded(const Strands& p, const Strands& drawn) {
    long crowded = 0, count = 0;
    for (int s = 0; s < p.count; ++s)
        for (int i = p.particles / 3; i < p.particles; i += 3, ++count) {
            bool met = false;
            for (int other = 0; other < p.count && !met; ++other)
                for (int j = 0; j < p.particles && other != s && !met; ++j)
                    met = norm(p.at(s, i) - p.at(other, j)) < 0.5 * radius &&
                          norm(drawn.at(s, i) - drawn.at(other, j)) > radius;
            crowded += met;
        }
    return double(crowded) / double(count);
}

struct Shaken {
    double crowded = 0, excess = -1e9, scale = 0;  // mean over frames; E - E0 - W and W at most [J]
    double taken = 0;                              // by contact [J]
};
Shaken shake(const std::string& more) {
    const Scene scene = scene_of(shaken + more);
    const auto simulation = make_simulation(scene, "float");
    auto total = [&] {
        double sum = 0;
        for (double e : simulation->energy()) sum += e;
        return sum;
    };
    simulation->count_work();
    const double start = total();
    Shaken out;
    for (int f = 0; f < 24; ++f) {
        simulation->advance();
        const double given = simulation->work().given();
        out.excess = std::max(out.excess, total() - start - given);
        out.scale = std::max(out.scale, std::abs(given));
        RunFrame frame;
        simulation->snapshot(frame);
        if (f % 6 == 5) out.crowded += crowded(frame.positions, scene.groom.rest) / 4;
    }
    EXPECT_FALSE(simulation->divergence());
    out.taken = simulation->work().strands;
    return out;
}

TEST(StrandContact, keeps_a_shaken_groom_apart_and_feeds_no_energy) {
    const Shaken without = shake(""), with = shake("[strand_contact]\nstrength = 50\n");
    std::printf(
        "head shake: %.1f %% of particles crowded without contact, %.1f %% with; contact took %.3g of "
        "%.3g J given, E - E0 - W is %.1g J at most\n",
        100 * without.crowded, 100 * with.crowded, -with.taken, with.scale, with.excess);
    EXPECT_GT(without.crowded, 0.01);
    EXPECT_LT(with.crowded, 0.9 * without.crowded);
    EXPECT_LT(with.taken, 0);
    EXPECT_LT(with.excess, 0.01 * with.scale);
}

TEST(StrandContact, is_not_there_where_it_is_not_named) {
    auto names_it = [](const Scene& scene) {
        const auto simulation = make_simulation(scene, "float");
        const Presence p = presence_of(scene);
        auto among = [](const auto& list) {
            return std::count(list.begin(), list.end(), std::string(StrandContact::name));
        };
        long buffers = 0;
        for (const auto& b : simulation->buffers()) buffers += b.name == StrandContact::name && b.bytes > 0;
        EXPECT_EQ(among(p.present) + among(p.absent), 1);
        EXPECT_EQ(among(p.present), among(simulation->stages));
        EXPECT_EQ(among(p.present), buffers);
        return among(p.present) == 1;
    };
    EXPECT_FALSE(names_it(scene_of(dry_scene)));
    EXPECT_TRUE(names_it(scene_of(dry_scene + "[strand_contact]\n")));
}

}  // namespace
}  // namespace wetcurl
