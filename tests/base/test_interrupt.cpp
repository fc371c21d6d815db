// Signals: within a guard they ask, outside they end the program, with a line and status 130.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <thread>

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

// timeout(1) sends a process one signal by its number and another one by its group's.
TEST(Interrupt, a_signal_that_comes_twice_within_a_moment_asks_once) {
    const auto stopped = [] {
        end_when_interrupted();
        {
            const InterruptGuard guard;
            std::raise(SIGTERM);
            std::raise(SIGTERM);
            std::raise(SIGINT);
            if (!guard.asked()) std::_Exit(1);
        }
        std::raise(SIGTERM);  // what was asked for is being said
        std::_Exit(42);
    };
    EXPECT_EXIT(stopped(), ::testing::ExitedWithCode(42), "");
}

TEST(Interrupt, the_second_signal_and_one_outside_of_a_guard_end_the_program) {
    const auto twice = [] {
        const InterruptGuard guard;
        std::raise(SIGINT);
        std::this_thread::sleep_for(std::chrono::milliseconds(1100));  // more than the moment
        std::raise(SIGTERM);
    };
    EXPECT_EXIT(twice(), ::testing::ExitedWithCode(130), "wetcurl: interrupted");
    const auto after = [] {
        end_when_interrupted();
        { const InterruptGuard guard; }
        std::raise(SIGTERM);
    };
    EXPECT_EXIT(after(), ::testing::ExitedWithCode(130), "wetcurl: interrupted");
}

}  // namespace
}  // namespace wetcurl
