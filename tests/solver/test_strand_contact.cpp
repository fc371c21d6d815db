// Contact between strands: momentum, forces against closed forms, and hair that keeps its volume and rests.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "solver/chain/chain_step.h"
#include "solver/chain/scene_checks.h"
#include "solver/strand_contact/strand_links.h"
#include "tests/base/threads.h"
#include "tests/solver/scenes.h"

namespace wetcurl {
namespace {

using namespace testing;

constexpr double dt = 1.0 / 480, radius = 0.004, edge = 0.003;
constexpr StrandContact usual{radius, 1e4, 0.3, 4};

// Strands drawn far apart that have come into one place, with unequal masses.
struct Tangle {
    Strands drawn, x, v;
    std::vector<float> mass;
    Tangle(int count, int particles, unsigned seed) : drawn(count, particles), x(drawn), v(drawn) {
        Random random(seed);
        for (size_t k = 0; k < drawn.points.size(); ++k) {
            drawn.points[k] = {float(k), 0, 0};
            x.points[k] = cast<float>(random.vector(0.006)), v.points[k] = cast<float>(random.vector(0.5));
            mass.push_back(float(random.number(1e-8, 8e-8)));
        }
    }
    // All wet.
    StrandLinks links(const StrandContact& term) const {
        StrandLinks out(term, drawn, edge);
        for (size_t k = 0; k < mass.size(); ++k) out.particles[k] = {x.points[k], mass[k], v.points[k], 1};
        return out;
    }
};

template <class V>
double largest(const std::vector<V>& a) {
    double most = 0;
    for (const auto& p : a) most = std::max(most, double(norm(p)));
    return most;
}

void scale(StrandLinks& links, float by) {
    for (auto& p : links.particles) p.x = by * p.x;
}

// Linked where they are, then moved nearer to each other: what they keep is their distance before.
StrandLinks pressed(const Tangle& t, const StrandContact& term) {
    StrandLinks links = t.links(term);
    links.find();
    scale(links, 0.7f);
    return links;
}

TEST(StrandContact, keeps_the_momentum_of_the_hair) {
    for (int particles : {2, 3, 20}) {
        StrandLinks links = pressed(Tangle(12, particles, 1), usual);
        links.evaluate(dt);
        Vec3d sum{0, 0, 0};
        double total = 0;
        for (const auto& f : links.force()) sum += cast<double>(f), total += norm(cast<double>(f));
        EXPECT_EQ(total > 0, particles > 2) << particles;  // the head moves two of each whole
        EXPECT_LE(norm(sum), 1e-6 * total) << particles;   // rounding of single precision
    }
}

// Every place stands once among those next to particles, in order, and lies on the strand's free edges.
TEST(StrandContact, places_are_those_of_the_particles_next_to_them) {
    for (uint32_t n : {2u, 3u, 20u, 64u})
        for (uint32_t count : {1u, 5u, 18u, 150u}) {
            const StrandPlaces places{n, count};
            uint32_t before = 0;
            for (uint32_t i = 0; i < n; ++i)
                for (uint32_t j = places.first_of(i); j < places.first_of(i + 1); ++j) {
                    EXPECT_EQ(j, before++);
                    const PlaceOnStrand at = places.at(7 * count + j);
                    const double u = double(at.edge - 7 * n) + double(at.along);
                    EXPECT_NEAR(u, 1 + (j + 0.5) * (n - 2) / count, 1e-5);
                    EXPECT_LE(std::abs(u - i), 0.50001);
                    EXPECT_LT(at.edge - 7 * n, n - 1);
                }
            EXPECT_EQ(before, count) << n;
        }
}

TEST(StrandContact, forces_are_the_slopes_of_their_potential) {
    // Without speed and slip there is no friction; particles alike: where masses differ along a strand, the
    // weight of a link changes with where it leads.
    Tangle t(12, 20, 2);
    t.v = Strands(12, 20), t.mass.assign(t.mass.size(), 3e-8f);
    const StrandContact term{radius, 1e4, 0, 4};
    StrandLinks links = pressed(t, term);
    std::vector<Vec3d> at;
    for (const auto& p : links.particles) at.push_back(cast<double>(p.x));
    links.evaluate(dt);
    double worst = 0, scale = largest(links.force());
    for (size_t k = 0; k < at.size(); k += 7)
        for (double Vec3d::*axis : {&Vec3d::x, &Vec3d::y, &Vec3d::z}) {
            const double there = at[k].*axis, way = 1e-7;
            at[k].*axis = there + way;
            const double above = links.potential(at);
            at[k].*axis = there - way;
            const double below = links.potential(at);
            at[k].*axis = there;
            const Vec3d force = cast<double>(links.force()[k]);
            worst = std::max(worst, std::abs(force.*axis + (above - below) / (2 * way)));
        }
    EXPECT_GT(scale, 0);
    EXPECT_LT(worst, 1e-3 * scale);
}

TEST(StrandContact, links_lead_to_the_nearest_place_of_each_strand) {
    Tangle t(12, 20, 3);
    // Strands as lines: a walk along them finds what is nearest.
    for (int s = 0; s < 12; ++s) {
        const Vec3f from = t.x.at(s, 0), way = normalized(t.x.at(s, 1) - from, Vec3f{0, 1, 0});
        for (int i = 0; i < 20; ++i) t.x.at(s, i) = from + (0.001f * float(i - 10)) * way;
    }
    StrandLinks links = t.links(usual);
    links.find();
    const StrandPlaces places = links.places();
    size_t seen = 0, missed = 0;
    for (uint32_t which = 0; which < 12 * places.count; ++which) {
        const PlaceOnStrand own = places.at(which);
        const uint32_t id = own.edge;
        const Vec3f p = own.position(t.x.points.data());
        auto on_edge = [&](uint32_t e) {
            return PlaceOnStrand{e, nearest_on(p, t.x.points[e], t.x.points[e + 1])};
        };
        std::vector<float> nearest;  // of each strand that this one is linked to
        for (uint32_t s = 0; s < 12; ++s) {
            if (s == id / 20 || !owns_link(id / 20, s)) continue;
            float least = 1;
            for (uint32_t e = s * 20; e + 1 < (s + 1) * 20; ++e)
                least = std::min(least, norm(p - on_edge(e).position(t.x.points.data())));
            nearest.push_back(least);
        }
        std::sort(nearest.begin(), nearest.end());
        std::vector<float> linked;
        for (int l = 0; l < most_links; ++l) {
            const StrandLink& link = links.links()[which * most_links + size_t(l)];
            if (link.other != StrandLink::none)
                linked.push_back(norm(p - on_edge(link.other).position(t.x.points.data())));
        }
        // All that it may touch, or as many of the nearest as there are links. Which are nearest is told by
        // particles, half an edge apart.
        const size_t touching =
            size_t(std::count_if(nearest.begin(), nearest.end(), [](float r) { return r < float(radius); }));
        EXPECT_GE(linked.size(), std::min(touching, size_t(most_links)));
        std::sort(linked.begin(), linked.end());
        for (size_t k = 0; k < linked.size(); ++k) {
            missed += linked[k] > nearest[k] + 0.0005f;
            ++seen;
        }
    }
    EXPECT_GT(seen, 300u);
    EXPECT_EQ(missed, 0u);
}

// Without a search: to where the nearest place is, by one edge a substep.
TEST(StrandContact, a_link_follows_the_nearest_place_from_edge_to_edge) {
    Tangle t(2, 20, 4);
    StrandLinks links = t.links(usual);
    auto lie = [&](float shift) {
        for (int i = 0; i < 20; ++i) {
            links.particles[size_t(i)].x = {0, 0.002f * float(i) + shift, 0};
            links.particles[size_t(20 + i)].x = {0.001f, 0.002f * float(i), 0};
        }
    };
    lie(0.0001f);
    links.find();
    ASSERT_TRUE(owns_link(0, 1));
    const size_t middle = links.places().count / 2 * size_t(most_links);
    auto edge = [&] { return links.links()[middle].other; };
    const uint32_t begin = edge();
    lie(0.0061f);  // three edges on
    for (uint32_t walked = 1; walked <= 3; ++walked) {
        links.evaluate(dt);
        EXPECT_EQ(edge(), begin + walked);
    }
    links.evaluate(dt);
    EXPECT_EQ(edge(), begin + 3);
}

TEST(StrandContact, keeps_its_links_until_others_are_much_nearer) {
    // Straight strands at these distances from the first; so many that it may be linked to, and one more.
    Tangle t(8, 20, 4);
    float away[8] = {0, 0.001f, 1, 0.0025f, 2, 0.004f, 3, 0.0044f};
    StrandLinks links = t.links(usual);
    auto linked_to = [&](uint32_t strand) {
        for (int s = 0; s < 8; ++s)
            for (int i = 0; i < 20; ++i)
                links.particles[size_t(20 * s + i)].x = {away[s] * (s % 4 == 1 ? 1.f : -1.f),
                                                         0.002f * float(i), 0};
        links.find();
        long count = 0;
        for (size_t l = 0; l < links.places().count * size_t(most_links); ++l)
            if (const uint32_t other = links.links()[l].other; other != StrandLink::none)
                count += other / 20 == strand;
        return count;
    };
    const long all = long(links.places().count);
    EXPECT_EQ(linked_to(5), all);
    away[7] = 0.0038f;
    EXPECT_EQ(linked_to(5), all);
    EXPECT_EQ(linked_to(7), 0);
    away[7] = 0.0030f;
    EXPECT_EQ(linked_to(7), all);
    EXPECT_EQ(linked_to(5), 0);
}

// Inside a bend two edges may be about as near: the link stays at the one that it had.
TEST(StrandContact, a_link_stays_at_its_edge_inside_a_bend) {
    Tangle t(2, 5, 4);
    StrandLinks links = t.links(usual);
    auto edge = [&](float nearer) {
        for (size_t i = 0; i < 5; ++i) {
            links.particles[i].x = {nearer, 0.001f, 0.0001f * float(i)};
            const float way = 0.003f * (float(i) - 2);
            links.particles[5 + i].x = {way, std::abs(way), 0};
        }
        links.find();
        return links.links()[0].other - 5;
    };
    const uint32_t left = edge(-0.0003f);
    EXPECT_LT(left, 2u);
    EXPECT_EQ(edge(0.0001f), left);
    EXPECT_EQ(edge(0.0008f), 2u);
}

TEST(StrandContact, leaves_the_groom_as_drawn_and_what_was_found_nearer) {
    Tangle t(12, 20, 6);
    t.v = Strands(12, 20);
    const StrandContact dry{radius, 3000, 0.3, 0};
    // Drawn apart and found together: nothing is pushed before it is pressed.
    StrandLinks links = t.links(dry);
    links.find(), links.evaluate(dt);
    EXPECT_GT(links.neighbours_mean(), 1);
    EXPECT_LT(largest(links.force()), 1e-12);
    t.drawn = t.x;
    StrandLinks as_drawn = t.links(dry);
    as_drawn.find();
    scale(as_drawn, 1.001f);
    as_drawn.evaluate(dt);
    EXPECT_EQ(largest(as_drawn.force()), 0);
    scale(as_drawn, 0.5f);
    as_drawn.evaluate(dt);
    EXPECT_GT(largest(as_drawn.force()), 0);
}

TEST(StrandContact, gives_the_same_bits_for_one_and_three_threads) {
    const Tangle t(40, 60, 9);
    const auto [one, three] = with_one_and_three_threads([&] {
        StrandLinks links = pressed(t, usual);
        links.evaluate(dt), links.evaluate(dt);
        return std::pair(links.force(), links.stiffness());
    });
    EXPECT_GT(largest(one.first), 0);
    EXPECT_EQ(std::memcmp(one.first.data(), three.first.data(), one.first.size() * sizeof(Vec3f)), 0);
    EXPECT_EQ(one.second, three.second);
}

TEST(StrandContact, carries_its_links_from_run_to_run) {
    const Tangle t(12, 20, 10);
    StrandLinks links = pressed(t, usual);
    links.evaluate(dt);
    Carried kept;
    links.save(kept);
    StrandLinks again = t.links(usual);
    again.resume(kept), again.particles = links.particles;
    for (StrandLinks* each : {&links, &again}) each->find(), each->evaluate(dt);
    EXPECT_EQ(std::memcmp(links.force().data(), again.force().data(), links.force().size() * sizeof(Vec3f)),
              0);
}

// Two straight strands side by side, rigid and free to move as they stand, and what accelerates the second
// against the first.
struct Pair {
    static constexpr int n = 60, linked = n - 2;  // particles; those of the first that have a link
    static constexpr float mass = 3e-8f;
    const Strands drawn;
    StrandLinks links;
    Vec3f x[2]{}, x_before[2]{}, v[2]{}, v_before[2]{};
    bool first = true;
    Pair(const StrandContact& term, double apart, float water)
        : drawn(as_drawn(apart)), links(term, drawn, edge) {
        links.particles.assign(2 * n, {{0, 0, 0}, mass, {0, 0, 0}, water});
    }
    LinkedParticle& at(int s, int i) { return links.particles[size_t(s * n + i)]; }
    static Strands as_drawn(double apart) {
        Strands out(2, n);
        for (int i = 0; i < n; ++i)
            for (int s = 0; s < 2; ++s)
                out.at(s, i) = {float(s ? apart / 2 : -apart / 2), -float(edge) * float(i), 0};
        return out;
    }
    // For so long [s], by the scheme of strands. Each takes half of the acceleration [m/s^2], as that of the
    // particles that have links.
    void run(double seconds, const Vec3f& acceleration) {
        for (int step = 0; step < int(std::lround(seconds / dt)); ++step, first = false) {
            const Bdf2<float> scheme(float(dt), first);
            Vec3f expected[2];
            for (int s = 0; s < 2; ++s) {
                expected[s] = scheme.predicted(x[s], x_before[s], v[s]);
                for (int i = 0; i < n; ++i) at(s, i).x = drawn.at(s, i) + expected[s], at(s, i).v = v[s];
            }
            if (step % 10 == 0) links.find();
            links.evaluate(dt);
            Vec3f change[2];
            for (int s = 0; s < 2; ++s) {
                Vec3f force = ((s ? 0.5f : -0.5f) * float(linked) * mass) * acceleration;
                float stiffness = 0;
                for (int i = 0; i < n; ++i)
                    force += links.force()[size_t(s * n + i)],
                        stiffness += links.stiffness()[size_t(s * n + i)];
                const float m = float(linked) * mass;
                change[s] = (1 / (m + scheme.h * scheme.h * stiffness)) *
                            scheme.right_side(m, v[s], v_before[s], v[s], force);
            }
            for (int s = 0; s < 2; ++s) {
                x_before[s] = x[s], v_before[s] = v[s];
                v[s] += change[s], x[s] = expected[s] + scheme.h * change[s];
            }
        }
    }
    // How far the second has moved against the first.
    Vec3f moved() const { return x[1] - x[0]; }
    Vec3f speed() const { return v[1] - v[0]; }
};

TEST(StrandContact, strands_pressed_together_near_each_other_by_load_over_strength) {
    // A load of a for each of two: the push of strength times the overlap, which begins smoothly. From 6e5 on
    // links are stiffer than a step bears as a force, up to twenty times.
    const double soft = double(StrandContact::soft) * radius;
    for (double strength : {3e3, 3e4, 3e5, 6e5, 1e6, 2e6, 5e6, 2e7}) {
        const double a = std::min(strength * 0.0004, 12.0), depth = a / strength;
        const double overlap = depth > soft / 2 ? depth + soft / 2 : std::sqrt(2 * soft * depth);
        Pair pair({radius, strength, 0.3, 0}, radius, 0);
        pair.run(6, {-2 * float(a), 0, 0});
        EXPECT_NEAR(double(pair.moved().x), -overlap, 0.003 * overlap + 1e-8) << strength;
        EXPECT_LT(double(norm(pair.speed())), 0.01 * a * dt) << strength;
    }
}

TEST(StrandContact, friction_holds_up_to_its_coefficient_and_slides_beyond) {
    constexpr float a = 1.2f;
    constexpr double mu = 0.5, strength = 3000;
    auto pull = [&](Pair& pair, double share, double seconds) {
        pair.run(seconds, {-2 * a, 2 * float(share * mu) * a, 0});
    };
    Pair held({radius, strength, mu, 0}, radius, 0);
    pull(held, 0, 2);
    const float before = held.moved().y;
    for (int k = 1; k <= 80; ++k) pull(held, 0.01 * k, 0.05);
    pull(held, 0.8, 1);
    // It gives way by the spring that holds it.
    const double way = 0.8 * mu * double(a) / (strength * double(StrandContact::held));
    EXPECT_NEAR(double(held.moved().y - before), way, 0.05 * way);
    EXPECT_LT(double(norm(held.speed())), 1e-4);

    Pair sliding({radius, strength, mu, 0}, radius, 0);
    pull(sliding, 0, 2), pull(sliding, 1.5, 0.06);
    const float v = sliding.speed().y;
    pull(sliding, 1.5, 0.06);
    const double gained = 2 * 0.5 * mu * double(a) * 0.06;  // each by half of mu a beyond what holds it
    EXPECT_NEAR(double(sliding.speed().y - v), gained, 0.03 * gained);
}

TEST(StrandContact, wet_strands_stay_together_up_to_their_cohesion) {
    // Each pulled by so much of it, a little more from time to time.
    auto apart_after = [](float share, float water) {
        Pair pair({radius, 1e4, 0.3, 4}, radius, water);
        for (int k = 1; k <= 40; ++k) pair.run(0.05, {2 * share * 4 * float(k) / 40, 0, 0});
        pair.run(1, {2 * share * 4, 0, 0});
        return double(pair.moved().x);
    };
    EXPECT_LT(apart_after(0.95f, 1), radius);
    EXPECT_GT(apart_after(1.05f, 1), 0.1);
    // The pull goes by both saturations.
    EXPECT_LT(apart_after(0.23f, 0.5f), radius);
    EXPECT_GT(apart_after(0.27f, 0.5f), 0.1);
    EXPECT_GT(apart_after(0.05f, 0), 0.1);
}

// --- in whole simulations

// The head turns to and fro within a second, and rests.
const std::string turns = R"([[motion.keyframe]]
time = 0
[[motion.keyframe]]
time = 0.2
rotation = [0, 0, 60]
[[motion.keyframe]]
time = 0.6
rotation = [0, 0, -60]
[[motion.keyframe]]
time = 0.95
)";
const std::string shaken = R"(fps = 24
[groom]
grid = [14, 14]
particles = 30
length = 0.15
scalp_radius = 0.05
lift = 0.01
[integrator]
settle = 0.5
[stretch]
[bend]
[core]
[stiffness]
)" + turns;

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
    double risen = -1e9;  // E over a frame after the head has come to rest, at most [J]
    double creep = 0;     // [m/s] in the mean, at the end
};
Shaken shake(const std::string& more, bool seen = true) {
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
    double before = 0;
    for (int f = 0; f < 72; ++f) {
        simulation->advance();
        const double given = simulation->work().given(), now = total();
        if (f < 24) {
            out.excess = std::max(out.excess, now - start - given);
            out.scale = std::max(out.scale, std::abs(given));
        } else if (f > 24) {
            out.risen = std::max(out.risen, now - before);
        }
        before = now;
        RunFrame frame;
        simulation->snapshot(frame);
        if (seen && f < 24 && f % 2 == 1) out.crowded += crowded(frame.positions, scene.groom.rest) / 12;
    }
    EXPECT_FALSE(simulation->divergence());
    const auto v = simulation->velocities();
    for (const auto& p : v) out.creep += double(norm(p)) / double(v.size());
    return out;
}

TEST(StrandContact, keeps_a_shaken_groom_apart_and_lets_it_rest) {
    const Shaken without = shake(""), with = shake("[strand_contact]\n");
    std::printf(
        "head shake: %.1f %% of particles crowded without contact, %.1f %% with; of %.3g J given, E - E0 - W "
        "is %.1g J at most; two seconds later hair creeps at %.3g mm/s, without contact %.3g\n",
        100 * without.crowded, 100 * with.crowded, with.scale, with.excess, 1e3 * with.creep,
        1e3 * without.creep);
    EXPECT_GT(without.crowded, 0.01);
    EXPECT_LT(with.crowded, 0.7 * without.crowded);
    EXPECT_LT(with.creep, 0.2 * without.creep);
}

// Above the scalp, the mean over the particles that lay over its upper fifth before the shake.
TEST(StrandContact, keeps_the_height_of_hair_on_the_crown) {
    auto heights = [](const std::string& more) {
        const Scene scene = scene_of(shaken + more +
                                     "[[solid]]\nname = \"head\"\nshape = \"sphere\"\nradius = 0.048\n"
                                     "attached = \"head\"\n");
        const auto simulation = make_simulation(scene, "float");
        auto positions = [&] {
            RunFrame frame;
            simulation->snapshot(frame);
            return frame.positions.points;
        };
        const auto before = positions();
        for (int f = 0; f < 72; ++f) simulation->advance();
        const auto after = positions();
        double sum = 0, sum_after = 0;
        long count = 0;
        for (size_t k = 0; k < before.size(); ++k)
            if (before[k].y > 0.6f * norm(before[k]))
                sum += double(norm(before[k])) - 0.05, sum_after += double(norm(after[k])) - 0.05, ++count;
        return std::pair(sum / double(count), sum_after / double(count));
    };
    const auto [before, after] = heights("[strand_contact]\n");
    const auto [before_without, after_without] = heights("");
    std::printf(
        "hair on the crown: %.2f mm high, %.2f after the head was shaken; without contact %.2f and %.2f\n",
        1e3 * before, 1e3 * after, 1e3 * before_without, 1e3 * after_without);
    EXPECT_NEAR(after / before, 1, 0.1);
}

TEST(StrandContact, feeds_no_energy_at_a_hundredth_to_a_hundred_times_its_strengths) {
    for (double times : {0.01, 1.0, 100.0}) {
        const Shaken of = shake("[wetness]\n[strand_contact]\nstrength = " + std::to_string(1e4 * times) +
                                    "\ncohesion = " + std::to_string(4 * times) + "\n",
                                false);
        std::printf(
            "strengths times %g: of %.3g J given, E - E0 - W is %.2g J at most; of hair whose head rests E "
            "rises by %.2g J at most, and it creeps at %.3g mm/s\n",
            times, of.scale, of.excess, of.risen, 1e3 * of.creep);
        EXPECT_LT(of.excess, 0) << times;
        EXPECT_LT(of.risen, 5e-3 * of.scale) << times;
    }
}

// Positions after four frames that begin where `moved` puts the particles, from the groom as drawn.
template <class Moved>
std::vector<Vec3f> after_four_frames(const Scene& scene, Moved moved) {
    const auto simulation = make_simulation(scene, "double");
    SimulationState start = simulation->state();
    for (auto& x : start.x) x += moved();
    simulation->restore(start);
    for (int f = 0; f < 4; ++f) simulation->advance();
    RunFrame frame;
    simulation->snapshot(frame);
    return frame.positions.points;
}

// Strands that are drawn touching keep just their distance: who presses first is a rounding's to say, and
// must not matter.
TEST(StrandContact, a_nanometre_decides_nothing) {
    const std::string turning = dry_scene + "[motion]\nangle = 40\nperiod = 0.2\n";
    const Scene scene = scene_of(turning + "[strand_contact]\n", {"groom.grid=[6, 6]"}),
                alone = scene_of(turning, {"groom.grid=[6, 6]"});
    auto farthest = [](const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
        double most = 0;
        for (size_t k = 0; k < a.size(); ++k) most = std::max(most, double(norm(a[k] - b[k])));
        return most;
    };
    auto drawn = [] { return Vec3d{0, 0, 0}; };
    const auto wanted = after_four_frames(scene, drawn);
    EXPECT_GT(farthest(after_four_frames(alone, drawn), wanted), 1e-4);
    for (unsigned seed : {1u, 2u, 3u}) {
        Random random(seed);
        const double off = farthest(after_four_frames(scene, [&] { return random.vector(1e-9); }), wanted);
        EXPECT_GT(off, 0) << seed;
        EXPECT_LT(off, 1e-6) << seed;
    }
}

// Wet coils of many particles, shaken, with cohesion in the solve beside: tips that many links lead to.
TEST(StrandContact, coils_that_were_shaken_come_to_rest) {
    const std::string coils = R"(fps = 24
[groom]
grid = [6, 6]
particles = 100
length = 0.15
[integrator]
substeps = 10
[wetness]
jitter = 0.3
[curl]
[cohesion]
radius = 0.012
strength = 5000
[adhesion]
[stiffness]
global = 6
[strand_contact]
[[solid]]
radius = 0.095
attached = "head"
[fibre]
)" + turns;
    for (const char* hair : {"type3c", "type4a"}) {
        const Scene scene = scene_of(coils, {std::string("fibre.hair='") + hair + "'"});
        const auto simulation = make_simulation(scene, "float");
        simulation->advance_by(0.5);
        EXPECT_GT(largest(simulation->velocities()), 0.1) << hair;
        for (int f = 0; f < 12 * 24; ++f) simulation->advance(false);
        const auto v = simulation->velocities();
        double mean = 0;
        for (const auto& p : v) mean += double(norm(p)) / double(v.size());
        std::printf("%s: %.2g mm/s in the mean, %.2g at most\n", hair, 1e3 * mean, 1e3 * largest(v));
        EXPECT_LT(mean, 1e-4) << hair;
        EXPECT_LT(largest(v), 1e-3) << hair;
    }
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
