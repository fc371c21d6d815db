// How wide locks are: of locks whose width is known, and of hair that Eq 10 draws together.
#include <gtest/gtest.h>

#include "app/measures/locks.h"
#include "solver/cohesion/cohesion_pass.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

using namespace testing;

constexpr int particles = 30;
constexpr double length = 0.2;  // [m]

TEST(Locks, are_as_wide_as_discs_of_known_width) {
    constexpr int locks = 16, of_each = 200;
    constexpr double width = 0.012, apart = 0.03, to_tip = 0.1;
    Random random(1);
    Strands simulated(locks * of_each, particles), displayed = simulated;
    for (int s = 0; s < simulated.count; ++s) {
        const int lock = s / of_each;
        const Vec3d middle{apart * (lock % 4), 0, apart * (lock / 4)};
        Vec3d in_disc;
        do {
            in_disc = {random.number(-1, 1), 0, random.number(-1, 1)};
        } while (norm(in_disc) > 1);
        for (int i = 0; i < particles; ++i) {
            const double along = double(i) / (particles - 1), drawn = 1 + (to_tip - 1) * along;
            const Vec3d down{0, -length * along, 0};
            simulated.at(s, i) = cast<float>(middle + down + (width / 2) * in_disc);
            displayed.at(s, i) = cast<float>(middle + down + (drawn * width / 2) * in_disc);
        }
    }
    const Locks found = locks_of(simulated, displayed, 0.006f);
    EXPECT_NEAR(found.gathered, width, 0.03 * width);
    EXPECT_NEAR(found.drawn, (1 + (to_tip - 1) * 20 / 29.) * width, 0.04 * width);
    EXPECT_NEAR(found.tips, (1 + (to_tip - 1) * 28 / 29.) * width, 0.02 * width);
    EXPECT_NEAR(found.strands, of_each, 1e-9);
    EXPECT_EQ(found.share, 1);
}

TEST(Locks, strands_that_are_alone_are_none) {
    Strands apart(9, particles);
    for (int s = 0; s < apart.count; ++s)
        for (int i = 0; i < particles; ++i)
            apart.at(s, i) = cast<float>(Vec3d{0.05 * s, -length * i / (particles - 1), 0});
    const Locks found = locks_of(apart, apart, 0.006f);
    EXPECT_EQ(found.share, 0);
    EXPECT_EQ(found.gathered, 0);
    EXPECT_EQ(locks_of(Strands(0, particles), Strands(0, particles), 0.006f).share, 0);
}

// Straight strands that hang from a square of 6 cm, drawn together as [cohesion] does where it is empty.
struct Curtain {
    Locks locks;
    double neighbours;
};
Curtain curtain(int each_way, int neighbours = 100) {
    Cohesion term;
    for (const auto& row : Cohesion::parameters)
        if (row.has_default())
            std::visit(
                [&](auto member) {
                    using Value = std::remove_reference_t<decltype(term.*member)>;
                    if constexpr (std::is_arithmetic_v<Value>) term.*member = Value(row.fallback);
                },
                row.member);
    term.h_c = term.lock_width / Cohesion::width_of_radius, term.neighbours = neighbours;
    term.spacing = Cohesion::spacing_of_radius * term.h_c;
    Random random(static_cast<unsigned>(each_way));
    Strands hair(each_way * each_way, particles);
    const double cell = 0.06 / each_way;
    for (int s = 0; s < hair.count; ++s) {
        const Vec3d root{cell * (s % each_way + random.number(0, 1)), 0,
                         cell * (s / each_way + random.number(0, 1))};
        for (int i = 0; i < particles; ++i)
            hair.at(s, i) = cast<float>(root + Vec3d{0, -length * i / (particles - 1), 0});
    }
    const std::vector<float> volume(hair.points.size(), 1e-10f), saturation(hair.points.size(), 1.f);
    CohesionPass pass(term, hair.count, Thinning(hair, term), volume, saturation);
    Strands drawn = hair;
    pass.apply(drawn);
    return {locks_of(hair, drawn, float(term.h_c / 2)), pass.neighbours_mean()};
}

TEST(Locks, are_as_wide_as_lock_width_says_whatever_is_drawn) {
    for (const int each_way : {14, 40, 100}) {
        const Curtain hair = curtain(each_way);
        EXPECT_NEAR(hair.locks.gathered, 0.012, 0.3 * 0.012) << each_way * each_way << " strands";
        EXPECT_LT(hair.locks.drawn, 0.6 * hair.locks.gathered) << each_way * each_way << " strands";
        EXPECT_GT(hair.locks.share, 0.75);
    }
}

TEST(Locks, of_dense_hair_come_from_few_neighbours) {
    const Curtain few = curtain(100), all = curtain(100, 0);
    EXPECT_GT(all.neighbours, 300);
    EXPECT_LT(few.neighbours, 130);
    EXPECT_GT(few.neighbours, 50);
    EXPECT_NEAR(few.locks.gathered, all.locks.gathered, 0.1 * all.locks.gathered);
    EXPECT_NEAR(few.locks.drawn, all.locks.drawn, 0.25 * all.locks.drawn);
}

}  // namespace
}  // namespace wetcurl
