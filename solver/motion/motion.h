// Prescribed motion of the head and of solids: C1 between keyframes.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/parameters.h"
#include "solver/motion/cuts.h"
#include "solver/motion/driven_motion.h"

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

// Of [motion] and [solid.motion], which stand in a shot.
struct CutsTable {
    std::vector<int> cuts;
    static constexpr Parameter<CutsTable> parameters[] = {
        {KeyRow::list(
             "cuts", 1, 1'000'000,
             "Frames of the scene which are the first after a cut: what moves stands elsewhere at once, and "
             "nothing has a velocity then. At a cut of the head the hair begins anew at its roots. Without "
             "the "
             "key, jumps that no body makes are cuts; [] has none."),
         &CutsTable::cuts},
    };
};
// Warns of cuts after `seconds`, at which the last frame is shown; infinite: there is none.
ShotCuts cuts_of(const Table& motion, double fps, double seconds);

// Of [motion] alone.
struct Preroll {
    double seconds = 0;
    static constexpr Parameter<Preroll> parameters[] = {
        {KeyRow::number("preroll", "s", 0, 0, 1000,
                        "Time simulated before frame 0, in which head and skin go from the pose in which the "
                        "hair was made to their first one."),
         &Preroll::seconds},
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
    bool moves() const { return driven_ || !keys_.empty() || period_ > 0; }
    // It comes to rest at keyframes on either side of these cuts.
    void rest_at(const ShotCuts& cuts);
    // From `time` [s] on, a caller drives it; it rests where it is then.
    DrivenMotion& driven_from(double time) { return driven_ ? *driven_ : driven_.emplace(time, at(time)); }

  private:
    struct Key {
        double time, value[6];  // rotation vector [rad], translation [m]
    };
    void read_file(const Table& table, const std::string& path);
    void check_times(const Table& table) const;
    std::vector<Key> keys_;
    std::vector<Key> slopes_;
    Vec3d pivot_{0, 0, 0};
    Vec3d axis_{0, 1, 0}, shift_{0, 0, 0};
    double angle_ = 0, period_ = 0, start_ = 0;
    std::optional<DrivenMotion> driven_;  // in place of the others
};

}  // namespace wetcurl
