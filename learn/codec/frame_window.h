// Frames in order, each once, with the head's pose one frame before and after.
#pragma once

#include <optional>

#include "base/frames.h"

namespace wetcurl {

// The head around one frame: what learning knows about motion.
struct HeadWindow {
    Pose before, now, after;
    // Whether there is a frame on both sides; velocity and acceleration are 0 where not. After a run's last
    // frame the head goes on as it has moved.
    bool inner = false;
    double fps = 24;
    Vec3d gravity{0, -9.81, 0};  // [m/s^2]

    // Of the head, world axes [rad/s], by central difference.
    Vec3d angular_velocity() const;
    // Of the point x of the head (head's frame) [m/s^2], world axes, by second difference: affine in x.
    Vec3d acceleration(const Vec3d& x) const;
};

// The pose a frame later, as the head has moved in the frame before.
Pose gone_on(const Pose& before, const Pose& now);

class FrameWindow final : public FrameSource {
  public:
    // `run` must outlive this. Gravity is that of the run's scene ([integrator] gravity).
    explicit FrameWindow(const RunReader& run);
    // The same of frames that come from elsewhere, of a run with that header; the source is one frame ahead.
    FrameWindow(FrameSource& frames, const RunHeader& header);
    FrameWindow(const FrameWindow&) = delete;
    bool advance() override;
    void begin(RunFrame& frame) override { frame = now_; }
    int index() const { return index_; }
    const RunFrame& now() const { return now_; }
    const HeadWindow& heads() const { return heads_; }

  private:
    std::optional<StoredFrames> stored_;
    FrameSource& frames_;
    bool has_next_ = false;
    RunFrame now_, next_;
    HeadWindow heads_;
    int index_ = -1;
};

// Gravity of a run's scene [m/s^2].
Vec3d gravity_of(const RunHeader& header);

}  // namespace wetcurl
