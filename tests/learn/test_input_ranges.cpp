// How far inputs lie outside of what a network learned from.
#include <gtest/gtest.h>

#include <string>

#include "learn/codec/input_ranges.h"

namespace wetcurl {
namespace {

// Inputs 0 to 1, but for the drag of dry hair, which was always 3, and the reach of Eq 10, at which the
// network does not look.
ModelCard card_of_ranges() {
    ModelCard card;
    card.arrays["input_low"].assign(strand_channels, 0);
    card.arrays["input_high"].assign(strand_channels, 1);
    const size_t drag = size_t(static_layout.fibre.first) + 3, reach = size_t(static_layout.reach.first);
    card.arrays["input_low"][drag] = card.arrays["input_high"][drag] = 3;
    card.arrays["input_low"][reach] = -1e30f, card.arrays["input_high"][reach] = 1e30f;
    return card;
}

// A strand in the middle of them.
std::vector<float> usual() {
    std::vector<float> row(strand_channels, 0.5f);
    row[size_t(static_layout.fibre.first) + 3] = 3;
    row[size_t(static_layout.reach.first)] = 1e6f;
    return row;
}

TEST(InputRanges, every_input_is_told_of_once) {
    std::vector<int> told(strand_channels, 0);
    for (const InputGroup& kind : told_inputs)
        for (int c = kind.channels.first; c < kind.channels.end(); ++c) ++told[size_t(c)];
    EXPECT_EQ(told, std::vector<int>(strand_channels, 1));
}

TEST(InputRanges, are_those_of_the_cards_arrays) {
    ModelCard card = card_of_ranges();
    EXPECT_TRUE(input_ranges(ModelCard()).empty());
    card.arrays["input_high"][size_t(static_layout.rest.first) + 5] = 7;
    card.arrays["input_low"][size_t(static_layout.rest.first) + 6] = -2;
    const auto ranges = input_ranges(card);
    ASSERT_EQ(ranges.size(), told_inputs.size());
    EXPECT_STREQ(ranges[0].name, "rest shape");
    EXPECT_EQ(ranges[0].low, -2);
    EXPECT_EQ(ranges[0].high, 7);
    EXPECT_EQ(ranges[1].high, 1);
}

TEST(InputRanges, of_four_strands_one_is_outside_by_half_a_range_and_one_by_a_constant) {
    InputsOutside outside(card_of_ranges());
    ASSERT_TRUE(outside.known());
    std::vector<float> rows;
    for (int s = 0; s < 4; ++s) {
        std::vector<float> row = usual();
        if (s == 1) row[size_t(in_input(dynamic_layout.acceleration).first) + 2] = -0.5f;
        if (s == 3) row[size_t(static_layout.saturation.first)] = 1.01f;  // as good as within
        if (s == 2) row[size_t(static_layout.fibre.first) + 3] = 3.06f;
        rows.insert(rows.end(), row.begin(), row.end());
    }
    outside.add(rows);
    rows = usual();
    outside.add(rows);  // of another frame
    EXPECT_DOUBLE_EQ(outside.share(), 0.4);
    const auto kinds = outside.kinds();
    ASSERT_EQ(kinds.size(), 2u);
    EXPECT_EQ(std::string(kinds[0].name), "drag when dry");
    EXPECT_DOUBLE_EQ(kinds[0].share, 0.2);
    EXPECT_NEAR(kinds[0].most, 2, 1e-4);  // hundredths of the constant
    EXPECT_EQ(std::string(kinds[1].name), "acceleration");
    EXPECT_NEAR(kinds[1].most, 0.5, 1e-6);
}

TEST(InputRanges, of_a_card_without_them_nothing_is_known) {
    InputsOutside outside((ModelCard()));
    EXPECT_FALSE(outside.known());
    outside.add(usual());
    EXPECT_EQ(outside.share(), 0);
    EXPECT_TRUE(outside.kinds().empty());
}

}  // namespace
}  // namespace wetcurl
