// Signals: within a guard they ask, outside they end the program, with a line and status 130.
// Ours.
#include <gtest/gtest.h>

#include "base/interrupt.h"

namespace wetcurl {
namespace {

TEST(Interrupt, within_a_guard_the_first_signal_only_asks) {
    for (const int signal : {SIGINT, SIGTERM}) {
        const InterruptGuard guard;
        EXPECT_FALSE(guard.asked());
        std::raise(signal);
        EXPECT_TRUE(guard.asked());
    }
    EXPECT_FALSE(InterruptGuard().asked());  // the next work begins unasked
}

TEST(Interrupt, the_second_signal_and_one_outside_of_a_guard_end_the_program) {
    const auto twice = [] {
        const InterruptGuard guard;
        std::raise(SIGINT);
        std::raise(SIGTERM);
    };
    EXPECT_EXIT(twice(), testing::ExitedWithCode(130), "wetcurl: interrupted");
    const auto after = [] {
        end_when_interrupted();
        { const InterruptGuard guard; }
        std::raise(SIGTERM);
    };
    EXPECT_EXIT(after(), testing::ExitedWithCode(130), "wetcurl: interrupted");
}

}  // namespace
}  // namespace wetcurl
