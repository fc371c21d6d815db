// Guides: which strands are simulated for the others.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "base/error.h"
#include "solver/grooms/guides.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

using testing::expect_error;

// 12 x 12 straight strands 1 cm apart; the right half is combed to the right, the left half to the left.
Groom parted() {
    constexpr int side = 12, particles = 9;
    Groom out;
    out.rest = Strands(side * side, particles);
    out.normal.assign(size_t(side * side), {0, 1, 0});
    out.grid = {side, side, {}};
    for (int s = 0; s < side * side; ++s) {
        out.grid.strand.push_back(s);
        const float x = 0.01f * float(s % side), z = 0.01f * float(s / side),
                    to = s % side < side / 2 ? -1.f : 1.f;
        for (int i = 0; i < particles; ++i)
            out.rest.at(s, i) = {x + to * 0.02f * float(i), 0.005f * float(i), z};
    }
    return out;
}

TEST(Guides, are_as_many_as_asked_for_each_once_and_rising) {
    const Groom groom = parted();
    for (int count : {1, 2, 7, 36, 144}) {
        const std::vector<int> guides = chosen_guides(groom, count);
        ASSERT_EQ(int(guides.size()), count);
        EXPECT_TRUE(std::is_sorted(guides.begin(), guides.end()));
        EXPECT_EQ(int(std::set<int>(guides.begin(), guides.end()).size()), count);
        EXPECT_GE(guides.front(), 0);
        EXPECT_LT(guides.back(), 144);
        EXPECT_EQ(chosen_guides(groom, count), guides);
    }
    for (int count : {0, 145})
        expect_error([&] { chosen_guides(groom, count); }, {"found " + std::to_string(count), "1 to 144"});
}

TEST(Guides, of_two_halves_that_differ_are_one_of_each) {
    const Groom groom = parted();
    const std::vector<int> two = chosen_guides(groom, 2);
    EXPECT_NE(two[0] % 12 < 6, two[1] % 12 < 6);
    // In the middle of its half, not at a corner, where the farthest would be.
    for (int guide : two) {
        EXPECT_GE(guide / 12, 4);
        EXPECT_LE(guide / 12, 7);
    }
}

TEST(Guides, leave_no_strand_far_away) {
    const Groom groom = parted();
    const std::vector<int> guides = chosen_guides(groom, 36);  // one in four
    for (int s = 0; s < 144; ++s) {
        float nearest = 1;
        for (int g : guides)
            if ((g % 12 < 6) == (s % 12 < 6))
                nearest = std::min(nearest, norm(groom.rest.at(g, 0) - groom.rest.at(s, 0)));
        EXPECT_LT(nearest, 0.0225f) << s;
    }
}

TEST(Guides, of_equal_strands_are_different_strands) {
    Groom groom = parted();
    for (int s = 0; s < 144; ++s) std::copy_n(groom.rest.strand(0), 9, groom.rest.strand(s));
    const std::vector<int> guides = chosen_guides(groom, 20);
    EXPECT_EQ(int(std::set<int>(guides.begin(), guides.end()).size()), 20);
}

}  // namespace
}  // namespace wetcurl
