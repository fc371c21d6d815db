// ShotCuts of a shot: frames at which what moves stands elsewhere at once.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace wetcurl {

struct ShotCuts {
    std::vector<int> frames;  // the first ones after a cut
    double fps = 24;
    bool said = false;  // by the scene, which then has no others

    bool at(int frame) const { return std::find(frames.begin(), frames.end(), frame) != frames.end(); }
    // The frame that ends at `time` [s] or is under way then.
    int frame_of(double time) const { return int(std::ceil(time * fps - 1e-6)); }
    // Whether things jump within the frame that ends at `time`, or is under way.
    bool within(double time) const { return !frames.empty() && at(frame_of(time)); }
    // `time`, or where things jump before the end of its frame, that end.
    double beyond(double time) const { return within(time) ? frame_of(time) / fps : time; }
    // Whether there is a jump from the one time to the other.
    bool between(double from, double to) const {
        return std::any_of(frames.begin(), frames.end(),
                           [&](int f) { return from < f / fps - 1e-9 && to > (f - 1) / fps + 1e-9; });
    }
    ShotCuts joined(const ShotCuts& more) const {
        ShotCuts out = *this;
        out.frames.insert(out.frames.end(), more.frames.begin(), more.frames.end());
        out.said = said || more.said;
        return out;
    }
};

}  // namespace wetcurl
