// The axial extent judged by helices, whose axis is known.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "app/measures/axial_extent.h"

namespace wetcurl {
namespace {

constexpr int particles = 60;

// One helix down from the origin.
Strands helix(double radius, double height, double turns) {
    Strands s(1, particles);
    for (int i = 0; i < particles; ++i) {
        const double t = double(i) / (particles - 1), angle = 2 * std::numbers::pi * turns * t;
        s.at(0, i) = {float(radius * (std::cos(angle) - 1)), float(-height * t),
                      float(radius * std::sin(angle))};
    }
    return s;
}

TEST(axial_extent, of_a_straight_strand_is_its_length) {
    EXPECT_NEAR(axial_extent(helix(0, 0.2, 0)), 0.2, 1e-5);
}

TEST(axial_extent, of_a_helix_is_the_length_of_its_axis) {
    const Strands s = helix(0.008, 0.15, 8);
    ASSERT_GT(arc_length(s.strand(0), particles), 1.5 * 0.15);  // the strand itself is much longer
    // The ends, where the filter sees half a turn, keep a little of the curl.
    EXPECT_NEAR(axial_extent(s), 0.15, 0.05 * 0.15);
}

TEST(axial_extent, shrinks_as_a_curl_of_the_same_length_tightens) {
    const Strands loose = helix(0.006, 0.18, 8);
    const double turn = 2 * std::numbers::pi * 8, length2 = 0.18 * 0.18 + std::pow(0.006 * turn, 2);
    const double height = 0.75 * 0.18, radius = std::sqrt(length2 - height * height) / turn;
    const Strands tight = helix(radius, height, 8);
    ASSERT_NEAR(arc_length(tight.strand(0), particles) / arc_length(loose.strand(0), particles), 1, 0.02);
    EXPECT_NEAR(axial_extent(tight) / axial_extent(loose), 0.75, 0.03);
}

TEST(axial_extent, of_nothing_is_nothing) { EXPECT_EQ(axial_extent(Strands(0, 0)), 0); }

}  // namespace
}  // namespace wetcurl
