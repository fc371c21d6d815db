// Eq 10 as a term and as a pass, against its symmetries and known gaps.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/geometry/kernels.h"
#include "solver/cohesion/cohesion_pass.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

using namespace testing;

constexpr double support = 0.012, tightness = 0.85;

// Eq 10 itself: no smoothing along the strand.
Cohesion eq10(int passes = 1) {
    Cohesion c{support, tightness, 0, unbounded, 0};
    c.passes = passes;
    return c;
}

struct Hair {
    Strands p;
    std::vector<float> volume, saturation;
    Hair(int count, int particles)
        : p(count, particles), volume(p.points.size(), 1e-10f), saturation(p.points.size(), 1.f) {}
    Strands displayed(const Cohesion& term) const {
        CohesionPass pass(term, p.count, Thinning(p, term), volume, saturation);
        Strands out = p;
        pass.apply(out);
        return out;
    }
};

// Strands down from a disc, near each other, with unequal volumes and saturations.
Hair tuft(int count, int particles, unsigned seed) {
    Random random(seed);
    Hair hair(count, particles);
    for (int s = 0; s < count; ++s) {
        const Vec3d root{random.number(-0.01, 0.01), 0, random.number(-0.01, 0.01)};
        for (int i = 0; i < particles; ++i)
            hair.p.at(s, i) = cast<float>(root + Vec3d{0, -0.004 * i, 0} + random.vector(0.001));
    }
    for (auto& v : hair.volume) v = float(random.number(0.5e-10, 2e-10));
    for (auto& s : hair.saturation) s = float(random.number(0, 1));
    return hair;
}

double moved(const Strands& a, const Strands& b) {
    double most = 0;
    for (size_t k = 0; k < a.points.size(); ++k)
        most = std::max(most, double(norm(a.points[k] - b.points[k])));
    return most;
}
bool same_bits(const Vec3f& a, const Vec3f& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

Cohesion smoothed(int passes) {
    Cohesion c = eq10(passes);
    c.coherence = 0.015;
    return c;
}

TEST(Cohesion, dry_hair_keeps_every_bit) {
    Hair hair = tuft(20, 15, 1);
    EXPECT_GT(moved(hair.displayed(eq10()), hair.p), 1e-4);
    std::fill(hair.saturation.begin(), hair.saturation.end(), 0.f);
    for (const auto& term : {eq10(10), smoothed(10)}) {
        const Strands out = hair.displayed(term);
        for (size_t k = 0; k < out.points.size(); ++k)
            EXPECT_TRUE(same_bits(out.points[k], hair.p.points[k]));
    }
}

TEST(Cohesion, a_lone_strand_and_one_without_neighbours_keep_every_bit) {
    Hair lone = tuft(1, 30, 2);
    for (auto& x : lone.p.points) x = 0.2f * x;  // its own particles are well within the support
    Hair apart = tuft(2, 30, 3);
    for (int i = 0; i < 30; ++i) apart.p.at(1, i) += {1, 0, 0};
    for (const Hair& hair : {lone, apart}) {
        const Strands out = hair.displayed(eq10(10));
        for (size_t k = 0; k < out.points.size(); ++k)
            EXPECT_TRUE(same_bits(out.points[k], hair.p.points[k]));
    }
}

TEST(Cohesion, roots_stay_on_the_scalp) {
    const Hair hair = tuft(20, 15, 4);
    for (const auto& term : {eq10(10), smoothed(4)}) {
        const Strands out = hair.displayed(term);
        for (int s = 0; s < 20; ++s) EXPECT_TRUE(same_bits(out.at(s, 0), hair.p.at(s, 0)));
        EXPECT_GT(moved(out, hair.p), 1e-4);
    }
}

TEST(Cohesion, displacements_do_not_depend_on_place_turn_or_order) {
    const Hair hair = tuft(20, 15, 5);
    const Quatd q = rotation_about({0, 0.6, 0.8}, 0.9);
    const Vec3d shift{0.5, -0.25, 1};
    Hair shifted = hair, turned = hair, permuted = hair;
    for (auto& x : shifted.p.points) x += cast<float>(shift);
    for (auto& x : turned.p.points) x = cast<float>(rotate(q, cast<double>(x)));
    auto other = [](int s) { return (7 * s + 3) % 20; };
    for (int s = 0; s < 20; ++s)
        for (int i = 0; i < 15; ++i) {
            const size_t to = size_t(other(s)) * 15 + size_t(i), from = size_t(s) * 15 + size_t(i);
            permuted.p.points[to] = hair.p.points[from];
            permuted.volume[to] = hair.volume[from];
            permuted.saturation[to] = hair.saturation[from];
        }
    for (const auto& term : {eq10(3), smoothed(3)}) {
        const Strands out = hair.displayed(term), out_shifted = shifted.displayed(term),
                      out_turned = turned.displayed(term), out_permuted = permuted.displayed(term);
        EXPECT_GT(moved(out, hair.p), 1e-3);
        for (int s = 0; s < 20; ++s)
            for (int i = 0; i < 15; ++i) {
                const Vec3d x = cast<double>(out.at(s, i));
                // One ulp of single precision at 1 m is 1e-7 m, and three passes amplify it.
                EXPECT_LT(norm(cast<double>(out_shifted.at(s, i)) - x - shift), 5e-6);
                EXPECT_LT(norm(cast<double>(out_turned.at(s, i)) - rotate(q, x)), 1e-6);
                EXPECT_LT(norm(cast<double>(out_permuted.at(other(s), i)) - x), 1e-6);
            }
    }
}

// Volumes that stand for all add up to about all, whatever share of them is seen.
TEST(Cohesion, strands_that_are_seen_stand_for_all) {
    const Hair hair = tuft(1000, 4, 8);
    for (const double seen : {0.5, 0.13}) {
        const Thinning thinning(4, 1, seen);
        const ThinnedWater water(thinning, hair.volume, hair.saturation);
        double all = 0, of_seen = 0;
        int strands = 0;
        for (int s = 0; s < 1000; ++s) {
            strands += thinning.sees(size_t(s));
            for (size_t k = 4 * size_t(s); k < 4 * size_t(s) + 4; ++k) {
                all += hair.volume[k], of_seen += water.volume[k];
                EXPECT_EQ(water.own_volume[k], hair.volume[k]);
                EXPECT_FLOAT_EQ(water.saturation[k], hair.saturation[k]);
                EXPECT_EQ(water.volume[k] > 0, thinning.sees(size_t(s)));
            }
        }
        EXPECT_NEAR(strands, 1000 * seen, 3);
        EXPECT_NEAR(of_seen, all, 0.05 * all);
    }
}

TEST(Cohesion, positions_stay_in_the_hull_of_the_hair) {
    const Hair hair = tuft(20, 15, 6);
    const Strands out = hair.displayed(eq10(10));
    Random random(7);
    for (int k = 0; k < 200; ++k) {
        const Vec3f n = cast<float>(random.direction());
        auto most = [&](const Strands& s) {
            float m = -1e9f;
            for (const auto& x : s.points) m = std::max(m, dot(n, x));
            return m;
        };
        EXPECT_LE(most(out), most(hair.p) + 1e-7f);
    }
}

// Two straight parallel strands `gap` apart; `spacing` [m] between particles. The gap at their middle after
// `term`, and what one pass should make of it.
double gap_after(double gap, double spacing, double& wanted_factor, const Cohesion& term = eq10()) {
    constexpr int n = 41;
    Hair hair(2, n);
    for (int s = 0; s < 2; ++s)
        for (int i = 0; i < n; ++i) hair.p.at(s, i) = cast<float>(Vec3d{s * gap, -spacing * i, 0});
    double weight = 0, own = 0;
    for (int k = -20; k <= 20; ++k) {
        weight += kernel(std::hypot(gap, spacing * k), support);
        own += kernel(std::abs(spacing * k), support);
    }
    wanted_factor = 1 - 2 * term.lambda * weight / (own + weight);
    const Strands out = hair.displayed(term);
    return double(out.at(1, n / 2).x) - double(out.at(0, n / 2).x);
}

TEST(Cohesion, the_gap_of_two_parallel_strands_shrinks_by_the_known_factor) {
    for (double spacing : {0.003, 0.006, 0.02})
        for (double gap : {0.001, 0.004, 0.009}) {
            double factor;
            const double after = gap_after(gap, spacing, factor);
            EXPECT_LT(factor, 0.995);
            EXPECT_NEAR(after, factor * gap, 1e-7);
        }
}

TEST(Cohesion, two_strands_never_change_places) {
    for (double spacing : {0.1 * support, 0.4 * support, support, 2 * support})
        for (double gap = 0.0005; gap < support; gap += 0.0005) {
            double factor;
            EXPECT_GT(gap_after(gap, spacing, factor), 0) << gap;
            EXPECT_GT(factor, 1 - tightness - 1e-12);
        }
}

TEST(Cohesion, displacement_is_continuous_where_a_neighbour_enters_the_support) {
    double factor;
    const double spacing = 2 * support;
    for (double share : {0.9, 0.99, 0.999, 1.0, 1.001}) {
        const double gap = share * support, change = gap - gap_after(gap, spacing, factor);
        // W falls as 2 (1 - q)³ of its value at zero; rounding of single precision at 1 cm.
        EXPECT_LE(change, 2 * tightness * 2 * std::pow(std::max(0.0, 1 - share), 3) * gap * 1.01 + 1e-8);
    }
    EXPECT_GT(0.9 * support - gap_after(0.9 * support, spacing, factor), 1e-5);
}

TEST(Cohesion, a_displacement_that_all_particles_share_is_kept_by_smoothing) {
    // Far along two long parallel strands smoothing finds nothing to change.
    auto gap_at_middle = [](const Cohesion& term) {
        constexpr int n = 401;
        Hair hair(2, n);
        for (int s = 0; s < 2; ++s)
            for (int i = 0; i < n; ++i) hair.p.at(s, i) = cast<float>(Vec3d{s * 0.004, -0.002 * i, 0});
        const Strands out = hair.displayed(term);
        return double(out.at(1, n / 2).x) - double(out.at(0, n / 2).x);
    };
    EXPECT_NEAR(gap_at_middle(eq10()), gap_at_middle(smoothed(1)), 1e-7);
    EXPECT_GT(std::abs(0.004 - gap_at_middle(eq10())), 1e-3);
}

TEST(Cohesion, no_displayed_edge_is_longer_than_allowed_and_directions_are_kept) {
    const Hair hair = tuft(20, 15, 8);
    Cohesion term = eq10(10);
    auto longest = [&](const Strands& out) {
        double most = 0;
        for (int s = 0; s < 20; ++s)
            for (int i = 0; i < 14; ++i)
                most = std::max(most, double(norm(out.at(s, i + 1) - out.at(s, i)) /
                                             norm(hair.p.at(s, i + 1) - hair.p.at(s, i))));
        return most;
    };
    EXPECT_GT(longest(hair.displayed(term)), 1.5);
    term.stretch = 0.05;
    EXPECT_NEAR(longest(hair.displayed(term)), 1.05, 1e-5);
    const Vec3d x{1, 0, 0}, end{1, 3, 0};
    EXPECT_LT(norm(term.within_length(x, end, 2.0) - Vec3d{1, 2.1, 0}), 1e-15);
    EXPECT_EQ(norm(term.within_length(x, end, 3.0) - end), 0);
}

Cohesion relaxed(int passes, double relaxation, Cohesion term = eq10()) {
    term.passes = passes, term.relaxation = relaxation;
    return term;
}
// What sweeps leave of a mode that a pass leaves 1 - x of.
double left_of(const Cohesion& term, double x) {
    double left = 1;
    for (int k = 0; k < term.sweeps(); ++k) left *= 1 - x * term.relaxed(k);
    return left;
}

TEST(OverRelaxedSweeps, move_slow_modes_as_far_as_all_passes_and_let_none_grow) {
    for (int passes = 1; passes <= 60; ++passes)
        for (double relaxation : {1.0, 1.1, 1.5, 1.75, 2.0, 2.5, 3.0, 3.4}) {
            const Cohesion term = relaxed(passes, relaxation);
            EXPECT_GE(term.sweeps() * relaxation, passes - 1e-9);
            EXPECT_LE(term.sweeps(), passes);
            double sum = 0;
            for (int k = 0; k < term.sweeps(); ++k) sum += term.relaxed(k);
            EXPECT_NEAR(sum, passes, 1e-9);
            for (double x = 0; x <= 1; x += 0.01) {
                EXPECT_LE(std::abs(left_of(term, x)), 1 + 1e-12) << passes << ' ' << relaxation << ' ' << x;
                // Nor does the first sweep alone leave anything farther off.
                EXPECT_LE(std::abs(1 - x * term.relaxed(0)), 1 + 1e-12);
            }
        }
    EXPECT_EQ(relaxed(14, 1).sweeps(), 14);
    EXPECT_EQ(relaxed(14, 2.5).sweeps(), 6);
    EXPECT_EQ(relaxed(10, 2.5).sweeps(), 4);
    EXPECT_EQ(relaxed(10, 3.4).sweeps(), 3);
    EXPECT_EQ(relaxed(14, 3).sweeps(), 5);
    EXPECT_EQ(relaxed(3, 2).sweeps(), 2);
    EXPECT_EQ(relaxed(2, 3).sweeps(), 2);
    EXPECT_EQ(relaxed(14, 1).relaxed(3), 1);
}

TEST(OverRelaxedSweeps, shrink_the_gap_of_two_parallel_strands_by_the_known_factor) {
    // So near each other that the weights stay those of the beginning.
    const double spacing = 2 * support;
    for (double relaxation : {1.0, 2.0, 2.5, 3.0, 3.4}) {
        Cohesion term = relaxed(14, relaxation);
        term.lambda = 0.1;
        double factor;
        const double gap = 1e-4, after = gap_after(gap, spacing, factor, term);
        EXPECT_NEAR(after, left_of(term, 1 - factor) * gap, 2e-7) << relaxation;
        EXPECT_GT(after, 0.1 * gap);
        EXPECT_LT(after, 0.3 * gap);
    }
}

// Straight drenched strands that lie close together: the stiffest there is.
TEST(OverRelaxedSweeps, keep_a_tight_lock_together) {
    constexpr int side = 6, n = 40;
    Hair hair(side * side, n);
    Random random(3);
    for (int s = 0; s < side * side; ++s) {
        const Vec3d root{0.0008 * (s % side), 0, 0.0008 * (s / side)};
        for (int i = 0; i < n; ++i)
            hair.p.at(s, i) = cast<float>(root + Vec3d{0, -0.003 * i, 0} + random.vector(0.0002));
    }
    const Vec3d middle{0.0008 * (side - 1) / 2, 0, 0.0008 * (side - 1) / 2};
    // Root mean square of how far from the axis the outer halves of strands are.
    auto width = [&](const Strands& p) {
        double sum = 0;
        for (int s = 0; s < p.count; ++s)
            for (int i = n / 2; i < n; ++i) {
                const Vec3d d = cast<double>(p.at(s, i)) - middle;
                sum += d.x * d.x + d.z * d.z;
            }
        return std::sqrt(sum / (p.count * (n - n / 2)));
    };
    for (double lambda : {0.85, 0.999})
        for (double coherence : {0.0, 0.01})
            for (int passes : {4, 10, 14, 100}) {
                Cohesion term = eq10();
                term.lambda = lambda, term.coherence = coherence;
                for (double relaxation : {2.0, 3.0, 3.4}) {
                    const double now = width(hair.displayed(relaxed(passes, relaxation, term)));
                    EXPECT_LT(now, 0.6 * width(hair.p)) << lambda << ' ' << coherence << ' ' << passes;
                }
            }
}

// Wavy strands of 2 mm edges that hang side by side.
Hair wavy(int count, int particles) {
    Random random(9);
    Hair hair(count, particles);
    for (int s = 0; s < count; ++s) {
        const Vec3d root{random.number(-0.01, 0.01), 0, random.number(-0.01, 0.01)};
        const double phase = random.number(0, 6.3);
        for (int i = 0; i < particles; ++i)
            hair.p.at(s, i) = cast<float>(root + Vec3d{0.002 * std::sin(0.2 * i + phase), -0.002 * i,
                                                       0.002 * std::cos(0.2 * i + phase)});
    }
    return hair;
}
Cohesion asked_every(double spacing, int passes = 5) {
    Cohesion c = smoothed(passes);
    c.spacing = spacing;
    return c;
}

TEST(Cohesion, asked_of_some_particles_it_nears_that_of_all) {
    const Hair hair = wavy(60, 101);
    const Strands all = hair.displayed(smoothed(5));
    auto mean = [&](const Strands& a, const Strands& b) {
        double sum = 0;
        for (size_t k = 0; k < a.points.size(); ++k) sum += norm(cast<double>(a.points[k] - b.points[k]));
        return sum / double(a.points.size());
    };
    const double full = mean(all, hair.p);
    ASSERT_GT(full, 1e-3);
    double before = full;
    for (double spacing : {0.012, 0.008, 0.006, 0.004}) {  // the support is 12 mm
        const double apart = mean(hair.displayed(asked_every(spacing)), all);
        EXPECT_LT(apart, 0.8 * before) << spacing;
        before = apart;
    }
    EXPECT_LT(before, 0.03 * full);
    EXPECT_EQ(moved(hair.displayed(asked_every(0.0029)), all), 0);  // nearer to one edge than to two
}

TEST(OverRelaxedSweeps, lead_wavy_hair_to_where_all_passes_do) {
    const Hair hair = wavy(60, 101);
    auto mean = [](const Strands& a, const Strands& b) {
        double sum = 0;
        for (size_t k = 0; k < a.points.size(); ++k) sum += norm(cast<double>(a.points[k] - b.points[k]));
        return sum / double(a.points.size());
    };
    const std::pair<double, double> bounds[] = {{2, 0.05}, {2.5, 0.05}, {3, 0.1}, {3.4, 0.25}};
    for (int passes : {10, 14, 20})
        for (auto [relaxation, bound] : bounds) {
            const Cohesion term = relaxed(passes, relaxation, smoothed(passes));
            const Strands all = hair.displayed(smoothed(passes));
            const double apart = mean(hair.displayed(term), all), way = mean(all, hair.p);
            std::printf("wavy hair, %d passes in %d sweeps: %.3g of the way apart\n", passes, term.sweeps(),
                        apart / way);
            EXPECT_LT(apart, bound * way);
        }
}

TEST(Cohesion, asked_of_some_particles_dry_hair_lone_strands_and_roots_keep_every_bit) {
    Hair dry = wavy(20, 50);
    std::fill(dry.saturation.begin(), dry.saturation.end(), 0.f);
    for (const Hair& hair : {dry, wavy(1, 50)})
        EXPECT_EQ(moved(hair.displayed(asked_every(0.006)), hair.p), 0);
    const Hair wet = wavy(20, 50);
    const Strands out = wet.displayed(asked_every(0.006));
    EXPECT_GT(moved(out, wet.p), 1e-3);
    for (int s = 0; s < 20; ++s) EXPECT_TRUE(same_bits(out.at(s, 0), wet.p.at(s, 0)));
}

TEST(Thinning, takes_root_and_tip_and_gives_linear_functions_and_sums_back) {
    for (int particles : {2, 3, 10, 64})
        for (int every : {1, 2, 3, 9}) {
            const Thinning thinning(particles, std::min(every, particles - 1));
            for (int strand : {0, 1, 2, 11}) {
                EXPECT_EQ(thinning.at(strand, 0), 0);
                EXPECT_EQ(thinning.at(strand, thinning.count - 1), particles - 1);
                for (int j = 0; j + 1 < thinning.count; ++j) {
                    EXPECT_LT(thinning.at(strand, j), thinning.at(strand, j + 1));
                    EXPECT_LE(thinning.at(strand, j + 1) - thinning.at(strand, j), 2 * thinning.every - 1);
                }
                for (int i = 0; i < particles; ++i) {
                    const auto [before, after] = thinning.place(strand, i);
                    EXPECT_NEAR((1 - after) * float(thinning.at(strand, before)) +
                                    after * float(thinning.at(strand, before + 1)),
                                i, 1e-4);
                    EXPECT_GE(after, 0);
                    EXPECT_LE(after, 1);
                }
            }
            const std::vector<float> whole(size_t(4 * particles), 0.25f);
            const auto sums = thinning.gathered(whole);
            ASSERT_EQ(sums.size(), size_t(4 * thinning.count));
            EXPECT_NEAR(std::accumulate(sums.begin(), sums.end(), 0.0), particles, 1e-4);
        }
}

TEST(Cohesion, coincident_particles_stay_finite) {
    Hair hair(3, 4);
    for (int s = 0; s < 3; ++s)
        for (int i = 0; i < 4; ++i) hair.p.at(s, i) = {0, -0.01f * float(i), 0};
    for (const auto& x : hair.displayed(eq10(10)).points) EXPECT_TRUE(std::isfinite(norm(x)));
}

}  // namespace
}  // namespace wetcurl
