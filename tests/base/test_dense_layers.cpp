// A small network as plain numbers, against a hand's.
#include "base/dense_layers.h"
#include "scratch.h"

namespace wetcurl {
namespace {

using testing::expect_error;

// h = LeakyReLU((x0 + 2 x1 + 0.5, 3 x0 - x1 - 1)), y = 4 h0 - 5 h1 - 6: the last layer's sum is taken as it
// is.
const DenseLayers by_hand({2, 2, 1}, {1, 2, 3, -1, 0.5f, -1, 4, -5, -6});

TEST(DenseLayers, give_what_a_hand_finds) {
    const float above[] = {2, 1}, below[] = {-2, 1};
    EXPECT_FLOAT_EQ(by_hand.evaluate(above), 4 * 4.5f - 5 * 4 - 6);
    EXPECT_FLOAT_EQ(by_hand.evaluate(below), 4 * 0.5f - 5 * -0.08f - 6);
    EXPECT_EQ(by_hand.inputs(), 2);
}

TEST(DenseLayers, answer_what_is_no_number_with_none) {
    const float inputs[] = {NAN, 1};
    EXPECT_TRUE(std::isnan(by_hand.evaluate(inputs)));
}

TEST(DenseLayers, say_which_sizes_cannot_be) {
    auto make = [](std::vector<int> sizes, size_t numbers) {
        return [=] { DenseLayers(sizes, std::vector<float>(numbers)); };
    };
    make({12, 6, 5, 4, 1}, 142)();
    make({16, 16, 1}, 17 * 16 + 17)();
    expect_error(make({12, 6, 5, 4, 1}, 141), {"12 6 5 4 1", "141 numbers", "142"});
    expect_error(make({12, 17, 1}, 239), {"12 17 1", "1 to 16"});
    expect_error(make({12, 0, 1}, 1), {"12 0 1", "1 to 16"});
    expect_error(make({12, 2}, 26), {"12 2", "last must be 1"});
    expect_error(make({1}, 0), {"1 to 8 layers"});
    expect_error(make({}, 0), {"1 to 8 layers"});
    expect_error(make(std::vector<int>(10, 1), 18), {"1 to 8 layers"});
}

}  // namespace
}  // namespace wetcurl
