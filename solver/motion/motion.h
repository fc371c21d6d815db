// Prescribed motion of the head and of solids: C1 between keyframes.
#pragma once

#include <vector>

#include "base/config.h"
#include "base/vec3.h"

namespace wetcurl {

class Motion {
  public:
    Motion() = default;  // at rest
    // [motion]: any of `rotation` / `translation` oscillations and keyframes
    //   axis, angle [degrees], shift [m, 3], period [s], start [s]: an oscillation that eases in; pivot [m,
    //   3]
    //   [[motion.keyframe]] time [s], rotation [degrees, 3: rotation vector], translation [m, 3]
    //   file = "…": lines of `time rx ry rz tx ty tz`
    explicit Motion(Table table);
    Pose at(double time) const;
    bool moves() const { return !keys_.empty() || period_ > 0; }

  private:
    struct Key {
        double time, value[6];  // rotation vector [rad], translation [m]
    };
    void read_file(Table table, const std::string& path);
    void finish(Table table);
    std::vector<Key> keys_;
    std::vector<Key> slopes_;
    Vec3d pivot_{0, 0, 0};
    Vec3d axis_{0, 1, 0}, shift_{0, 0, 0};
    double angle_ = 0, period_ = 0, start_ = 0;
};

}  // namespace wetcurl
