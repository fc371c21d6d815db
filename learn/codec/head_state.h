// What the motion of the head brings to a frame, as codecs read it on any device.
#pragma once

#include "learn/codec/frame_window.h"

namespace wetcurl {

// In the head's frame, but for the pose.
struct HeadState {
    Quatf rotation;          // head to world
    Vec3f translation;       // [m]
    Vec3f gravity, turning;  // [m/s^2], [rad/s]
    Vec3f pull, pull_x[3];   // acceleration of the point x: pull + sum_a pull_x[a] x_a [m/s^2]
    int first;               // whether there is no frame before
    int slot = 0;            // of the past, which is a ring, the frame's
    HeadState() = default;
    HeadState(const HeadWindow& heads, bool first);
};

}  // namespace wetcurl
