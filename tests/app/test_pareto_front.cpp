// The front and its hypervolume against analysis.
#include <gtest/gtest.h>

#include <cmath>

#include "app/measures/pareto_front.h"

namespace wetcurl {
namespace {

using Indices = std::vector<size_t>;

TEST(Front, holds_what_no_other_betters) {
    EXPECT_TRUE(front_of({}).empty());
    EXPECT_EQ(front_of({{1, 1}}), Indices{0});
    // By rising time: 2 is as slow as 0 and worse, 3 slower and worse, 1 the nearest of all.
    EXPECT_EQ(front_of({{0.2, 5}, {0.4, 1}, {0.2, 6}, {0.3, 5.5}, {0.1, 9}}), (Indices{4, 0, 1}));
    // As near and slower is bettered; as fast and nearer betters.
    EXPECT_EQ(front_of({{0.2, 5}, {0.1, 5}}), Indices{1});
    EXPECT_EQ(front_of({{0.1, 5}, {0.1, 4}}), Indices{1});
    // Equals do not better each other; an error of nothing ends the front.
    EXPECT_EQ(front_of({{0.1, 5}, {0.1, 5}, {0.3, 0}, {0.4, 0}}), (Indices{0, 1, 2}));
}

TEST(Hypervolume, is_the_area_of_decades_under_the_worst_cost) {
    EXPECT_EQ(log_hypervolume({}), 0);
    // Two decades in time, one in error.
    EXPECT_NEAR(log_hypervolume({{0.01, 10}}), 2, 1e-12);
    // A staircase: [-2, 0] x [1, 2] and [-1, 0] x [0, 1]; what is bettered, or equal, adds nothing.
    EXPECT_NEAR(log_hypervolume({{0.1, 1}, {0.01, 10}}), 3, 1e-12);
    EXPECT_NEAR(log_hypervolume({{0.1, 1}, {0.01, 10}, {0.1, 10}, {0.2, 2}, {0.1, 1}}), 3, 1e-12);
    // Of three steps: 3 x 0.5 + 2 x 0.5 + 1 x 1.
    EXPECT_NEAR(log_hypervolume({{1e-1, 1}, {1e-3, std::pow(10, 1.5)}, {1e-2, 10}}), 3.5, 1e-12);
    // Another worst cost: one decade each way.
    EXPECT_NEAR(log_hypervolume({{0.1, 1}}, {1, 10}), 1, 1e-12);
}

TEST(Hypervolume, ends_at_the_worst_and_the_best_cost) {
    EXPECT_EQ(log_hypervolume({{1, 1}, {2, 1}, {0.1, 100}, {0.1, 200}}), 0);
    EXPECT_NEAR(log_hypervolume({{0.01, 10}, {5, 0.5}}), 2, 1e-12);
    EXPECT_NEAR(log_hypervolume({{0, 0}}), 20, 1e-12);  // 5 decades by 4
    EXPECT_NEAR(log_hypervolume({{1e-9, 1e-9}}), 20, 1e-12);
    EXPECT_NEAR(log_hypervolume({{0.1, 0}}), 4, 1e-12);
}

}  // namespace
}  // namespace wetcurl
