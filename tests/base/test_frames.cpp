// Frames from sources to sinks: order, overlap, signals, errors.
#include <gtest/gtest.h>

#include <chrono>
#include <csignal>
#include <future>

#include "base/error.h"
#include "base/frames.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

using testing::expect_error;

// Frames whose `seconds` are their number; it throws at `fails_at`.
class Counted final : public FrameSource {
  public:
    explicit Counted(int frames, int fails_at = -1) : frames_(frames), fails_at_(fails_at) {}
    bool advance() override {
        ++index_;
        if (index_ == fails_at_) throw Error("the source fails");
        if (index_ == 1) second_.set_value();
        return index_ < frames_;
    }
    void begin(RunFrame& frame) override { frame.seconds = index_; }
    void finish(RunFrame& frame) override { frame.stage_seconds = {float(frame.seconds)}; }
    // Whether frame 1 is computed, within a time that no other reason needs.
    bool reaches_frame_1() {
        return second_.get_future().wait_for(std::chrono::milliseconds(500)) == std::future_status::ready;
    }

  private:
    int frames_, fails_at_, index_ = -1;
    std::promise<void> second_;
};

class Delivery : public ::testing::TestWithParam<bool> {
  protected:
    FrameDelivery delivery(int frames) const { return {{"", frames, GetParam()}, guard}; }
    InterruptGuard guard;
};

TEST_P(Delivery, brings_whole_frames_in_order_and_their_times) {
    FrameDelivery frames = delivery(4);
    Counted source(100);
    std::vector<double> found;
    frames.run(source, [&](int index, const RunFrame& frame) {
        EXPECT_EQ(frame.seconds, index);
        EXPECT_EQ(frame.stage_seconds, std::vector<float>{float(index)});
        found.push_back(frame.seconds);
    });
    EXPECT_EQ(found, (std::vector<double>{0, 1, 2, 3}));
    EXPECT_EQ(frames.seconds(), (std::vector<double>{1, 2, 3}));  // frame 0 took none
    EXPECT_TRUE(frames.is_whole());
}

TEST_P(Delivery, ends_where_the_source_does) {
    FrameDelivery frames = delivery(10);
    Counted source(3);
    frames.run(source, [](int, const RunFrame&) {});
    EXPECT_EQ(frames.delivered(), 3);
    EXPECT_FALSE(frames.is_whole());
}

TEST_P(Delivery, works_beside_the_source_where_asked_and_its_frame_stays_meanwhile) {
    FrameDelivery frames = delivery(3);
    Counted source(3);
    frames.run(source, [&](int index, const RunFrame& frame) {
        if (index > 0) return;
        EXPECT_EQ(source.reaches_frame_1(), GetParam());
        EXPECT_EQ(frame.seconds, 0);
    });
    EXPECT_GT(frames.sink_seconds(), 0);
}

TEST_P(Delivery, stops_at_a_signal) {
    FrameDelivery frames = delivery(1000);
    Counted source(1000);
    frames.run(source, [](int index, const RunFrame&) {
        if (index == 2) raise(SIGTERM);
    });
    EXPECT_GE(frames.delivered(), 3);
    EXPECT_LE(frames.delivered(), 4);
    EXPECT_FALSE(frames.is_whole());
}

TEST_P(Delivery, brings_what_came_before_an_error_of_the_source) {
    FrameDelivery frames = delivery(5);
    Counted source(5, 3);
    int found = 0;
    expect_error([&] { frames.run(source, [&](int, const RunFrame&) { ++found; }); }, {"the source fails"});
    EXPECT_EQ(found, 3);
    EXPECT_EQ(frames.delivered(), 3);
}

TEST_P(Delivery, ends_with_an_error_of_the_sink) {
    FrameDelivery frames = delivery(5);
    Counted source(5);
    expect_error(
        [&] {
            frames.run(source, [&](int index, const RunFrame&) {
                if (index == 1) throw Error("the sink fails");
            });
        },
        {"the sink fails"});
    EXPECT_EQ(frames.delivered(), 1);
}

INSTANTIATE_TEST_SUITE_P(Frames, Delivery, ::testing::Bool(),
                         [](const auto& info) { return info.param ? "overlapped" : "in_turn"; });

}  // namespace
}  // namespace wetcurl
