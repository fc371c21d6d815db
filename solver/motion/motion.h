// Prescribed motion of the head and of solids: C1 between keyframes.
#pragma once

#include <string>
#include <vector>

#include "base/parameters.h"

namespace wetcurl {

// [motion] as it is written: an oscillation that eases in, and a file of keyframes.
struct MotionTable {
    Vec3d pivot, axis, shift;
    double angle, period, start;
    std::string file;
    static constexpr Parameter<MotionTable> parameters[] = {
        {KeyRow::numbers("pivot", "m", {0, 0, 0}, -1e4, 1e4, "Point that rotations leave in place."),
         &MotionTable::pivot},
        {KeyRow::numbers("axis", "1", {0, 1, 0}, -1, 1, "Direction of the axis of the oscillation."),
         &MotionTable::axis},
        {KeyRow::number("angle", "degrees", 0, -720, 720, "Amplitude of the rotation about that axis."),
         &MotionTable::angle},
        {KeyRow::numbers("shift", "m", {0, 0, 0}, -100, 100, "Amplitude of the translation."),
         &MotionTable::shift},
        {KeyRow::number("period", "s", 0, 0, 1e4,
                        "Period of the oscillation, which eases in over its first half; 0: none."),
         &MotionTable::period},
        {KeyRow::number("start", "s", 0, 0, 1e4, "Time at which the oscillation begins."),
         &MotionTable::start},
        {KeyRow::path("file", "none",
                      "Keyframes as text, one a line: time [s], rotation vector [degrees], translation [m]."),
         &MotionTable::file},
    };
};

// [[motion.keyframe]].
struct KeyframeTable {
    double time;
    Vec3d rotation, translation;
    static constexpr Parameter<KeyframeTable> parameters[] = {
        {KeyRow::number("time", "s", 0, 0, 1e6, "Time of the keyframe; times grow from one to the next."),
         &KeyframeTable::time},
        {KeyRow::numbers("rotation", "degrees", {0, 0, 0}, -3600, 3600, "Rotation vector: axis times angle."),
         &KeyframeTable::rotation},
        {KeyRow::numbers("translation", "m", {0, 0, 0}, -1e4, 1e4, "Translation."),
         &KeyframeTable::translation},
    };
};

class Motion {
  public:
    Motion() = default;  // at rest
    // A table of these rows, with [[keyframe]] in it. Throws Misuse with file and line.
    explicit Motion(const Table& table);
    Pose at(double time) const;
    bool moves() const { return !keys_.empty() || period_ > 0; }

  private:
    struct Key {
        double time, value[6];  // rotation vector [rad], translation [m]
    };
    void read_file(const Table& table, const std::string& path);
    void finish(const Table& table);
    std::vector<Key> keys_;
    std::vector<Key> slopes_;
    Vec3d pivot_{0, 0, 0};
    Vec3d axis_{0, 1, 0}, shift_{0, 0, 0};
    double angle_ = 0, period_ = 0, start_ = 0;
};

}  // namespace wetcurl
