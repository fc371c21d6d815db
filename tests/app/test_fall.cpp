// The box and the angle judged by strands whose shape is known.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "app/measures/fall.h"

namespace wetcurl {
namespace {

constexpr int particles = 50;
constexpr double length = 0.3, bend_at = 0.5;  // [m], share of the length
const SolidDistance none;

// Straight down to the bend, then turned so that both parts make `angle` [degrees]; the second part lies on
// the solid, whose distance is that to the bend's height along the first.
Strands bent(double angle) {
    Strands s(1, particles);
    const double turn = (180 - angle) * std::numbers::pi / 180;
    for (int i = 0; i < particles; ++i) {
        const double t = length * i / (particles - 1), free = std::min(t, bend_at * length), held = t - free;
        s.at(0, i) = {float(held * std::sin(turn)), float(-free - held * std::cos(turn)), 0};
    }
    return s;
}
// Touches where the strand has turned off the first part's line.
float off_the_line(const Vec3f& x, const Pose&, double) { return std::abs(x.x) > 1e-6f ? 0.0f : 0.1f; }

TEST(fall, box_is_that_of_the_extreme_particles) {
    Strands s(2, 2);
    s.at(0, 0) = {0, 1, 5}, s.at(0, 1) = {0.5f, 0, 0};
    s.at(1, 0) = {-0.25f, 0.5f, 0}, s.at(1, 1) = {0, -2, -7};
    const Fall fall = fall_of(s, none, Pose{}, 0);
    EXPECT_NEAR(fall.width, 0.75, 1e-6);
    EXPECT_NEAR(fall.height, 3, 1e-6);
    EXPECT_FALSE(fall.angle);
}

TEST(fall, drop_is_the_mean_of_tips_below_their_roots) {
    Strands s(2, 2);
    s.at(0, 0) = {0, 1, 0}, s.at(0, 1) = {3, 0.5f, 0};
    s.at(1, 0) = {0, 1, 0}, s.at(1, 1) = {0, -0.5f, 4};
    EXPECT_NEAR(fall_of(s, none, Pose{}, 0).drop, 1, 1e-6);
}

TEST(fall, angle_is_that_between_the_free_and_the_held_part) {
    for (const double angle : {60.0, 90.0, 135.0, 170.0}) {
        const Fall fall = fall_of(bent(angle), off_the_line, Pose{}, 0);
        ASSERT_TRUE(fall.angle) << angle;
        // It is taken at the first particle past the corner, a tenth of the part or less away.
        EXPECT_NEAR(*fall.angle, angle, 0.1 * (180 - angle)) << angle;
    }
}

TEST(fall, a_strand_that_touches_nothing_has_no_angle) {
    EXPECT_FALSE(fall_of(bent(180), off_the_line, Pose{}, 0).angle);
}

TEST(fall, bounce_is_the_second_difference_of_what_lies_on_the_solid) {
    Bounce bounce;
    EXPECT_FALSE(bounce.value());
    // The first slides evenly, the second hops by 1 mm every other frame, the third is too far away.
    for (int f = 0; f < 6; ++f) {
        bounce.add({0.001f + 0.0005f * float(f), f % 2 ? 0.001f : 0.0f, f % 2 ? 0.1f : 0.2f});
        EXPECT_EQ(bool(bounce.value()), f >= 2) << f;
    }
    EXPECT_NEAR(*bounce.value(), std::sqrt((0 + 4e-6) / 2), 1e-6);
}

TEST(fall, of_nothing_is_nothing) { EXPECT_EQ(fall_of(Strands(0, 0), none, Pose{}, 0).width, 0); }

}  // namespace
}  // namespace wetcurl
