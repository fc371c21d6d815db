// A rigid motion that a caller gives span by span, as it becomes known: C1 from one span to the next.
#pragma once

#include <algorithm>
#include <cmath>

#include "base/vec3.h"

namespace wetcurl {

// Where a value stands at the share s of a span of length h, which it entered at the rate `rate` and leaves
// at that of the way from end to end: from + of_rate h rate + of_way (to - from).
struct DrivenWeights {
    double of_rate, of_way;
    explicit DrivenWeights(double s) : of_rate(s * (1 - s) * (1 - s)), of_way(s * s * (2 - s)) {}
};

class DrivenMotion {
  public:
    // At rest.
    DrivenMotion(double time, const Pose& pose) : begin_(time), end_(time), from_(pose), to_(pose) {}

    // From where and as fast as it is at the end of the last span [s] to `pose` at the time `end`.
    void go_to(double end, const Pose& pose) {
        begin_ = end_, end_ = end, from_ = to_, to_ = pose;
        way_ = to_.translation - from_.translation, turn_ = turn_from(from_.rotation, to_.rotation);
        const double span = end_ - begin_;
        velocity_before_ = velocity_, spin_before_ = spin_;
        velocity_ = (1 / span) * way_, spin_ = (1 / span) * turn_;
    }
    // It rests there from `time` on.
    void jump_to(double time, const Pose& pose) { *this = DrivenMotion(time, pose); }

    Pose at(double time) const {
        if (!(time > begin_)) return from_;
        if (!(time < end_)) return to_;
        const double span = end_ - begin_;
        const DrivenWeights w((time - begin_) / span);
        const Vec3d turn = w.of_rate * span * spin_before_ + w.of_way * turn_;
        Pose out = from_;
        out.translation += w.of_rate * span * velocity_before_ + w.of_way * way_;
        if (const double angle = norm(turn); angle > 0)
            out.rotation = rotation_about((1 / angle) * turn, angle) * from_.rotation;
        return out;
    }
    const Pose& at_end() const { return to_; }

  private:
    // The rotation vector [rad] from one to the other, the short way.
    static Vec3d turn_from(const Quatd& from, const Quatd& to) {
        Quatd d = to * conjugate(from);
        if (d.w < 0) d = {-d.w, -d.x, -d.y, -d.z};
        const Vec3d v{d.x, d.y, d.z};
        const double sine = norm(v);
        return sine > 0 ? (2 * std::atan2(sine, d.w) / sine) * v : Vec3d{0, 0, 0};
    }

    double begin_, end_;  // [s]
    Pose from_, to_;
    Vec3d way_{0, 0, 0}, turn_{0, 0, 0};                     // [m], [rad]
    Vec3d velocity_{0, 0, 0}, spin_{0, 0, 0};                // at the end
    Vec3d velocity_before_{0, 0, 0}, spin_before_{0, 0, 0};  // at the begin
};

}  // namespace wetcurl
