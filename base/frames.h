// Frames in order, from where they are computed or stored to where they are used.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/interrupt.h"
#include "base/run_cache.h"

namespace wetcurl {

// Where frames come from: a run file, or a simulation as it computes them (app/engine/simulated_frames.h).
class FrameSource {
  public:
    virtual ~FrameSource() = default;
    // Goes to the next frame, at first to frame 0. False: there is none left.
    virtual bool advance() = 0;
    // `begin` and `finish` fill `frame` with the frame at hand, whole. `finish` may wait for a device, on
    // another thread, while `advance` computes the next frame.
    virtual void begin(RunFrame& frame) = 0;
    virtual void finish(RunFrame&) {}
    // All three.
    bool next(RunFrame& frame);
};

// The frames of a run file, which must outlive this.
class StoredFrames final : public FrameSource {
  public:
    explicit StoredFrames(const RunReader& run) : run_(run) {}
    bool advance() override { return ++index_ < run_.frames(); }
    void begin(RunFrame& frame) override { frame = run_.frame(index_); }

  private:
    const RunReader& run_;
    int index_ = -1;
};

// Delivers frames of a source to a sink, with a progress bar, until a signal asks to stop.
class FrameDelivery {
  public:
    struct Settings {
        std::string what;  // the name of the progress bar; "": there is none
        int frames;        // at most so many are delivered
        // The sink acts on another thread, while the source computes its next frame: worth it where a device
        // computes and a processor writes.
        bool overlap = false;
        std::function<std::string()> note = {};  // at the end of the progress bar, after each frame
        // Run times [s] of frames 0, 1, ... that are delivered already; the source goes on after them.
        std::vector<double> earlier = {};
    };
    using Sink = std::function<void(int index, const RunFrame& frame)>;

    // The guard must outlive this.
    FrameDelivery(Settings settings, const InterruptGuard& guard)
        : settings_(std::move(settings)), guard_(guard), delivered_(int(settings_.earlier.size())) {
        if (delivered_ > 0) seconds_.assign(settings_.earlier.begin() + 1, settings_.earlier.end());
    }
    // Returns when all frames are delivered, none is left, or a signal has come. What source and sink throw
    // goes on to the caller, after a frame that is still on its way has been delivered.
    void run(FrameSource& source, const Sink& sink);

    int delivered() const { return delivered_; }
    bool is_whole() const { return delivered_ == settings_.frames; }
    // Run times [s] of the frames, without frame 0, for which nothing was computed.
    const std::vector<double>& seconds() const { return seconds_; }
    // Spent in `finish` and in the sink [s], all frames together.
    double sink_seconds() const { return sink_seconds_; }

  private:
    Settings settings_;
    const InterruptGuard& guard_;
    int delivered_;
    std::vector<double> seconds_;
    double sink_seconds_ = 0;
};

}  // namespace wetcurl
