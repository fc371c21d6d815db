// A run read frame by frame, each frame once, with the head's pose one frame before and after.
#pragma once

#include "base/run_cache.h"

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

class FrameWindow {
  public:
    // `run` must outlive this. Gravity is that of the run's scene ([integrator] gravity).
    explicit FrameWindow(const RunReader& run);
    // To the first frame, then to the next; false when there is none left.
    bool advance();
    int index() const { return index_; }
    const RunFrame& now() const { return now_; }
    const HeadWindow& heads() const { return heads_; }

  private:
    const RunReader& run_;
    RunFrame now_, next_;
    HeadWindow heads_;
    int index_ = -1;
};

// Gravity of a run's scene [m/s^2].
Vec3d gravity_of(const RunHeader& header);

}  // namespace wetcurl
