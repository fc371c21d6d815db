// A low-resolution run brought to every high-resolution root, without a network: the rows that a learned
// result is judged against. A strand is
// moved rigidly from its own root to the new one (offsets in world axes): turning it with the root frames as
// well would turn its droop away from gravity. Roots come from the rest groom and the head's pose, so they
// are exact.
#pragma once

#include <optional>
#include <vector>

#include "base/thread_room.h"
#include "learn/codec/carried_rest.h"
#include "learn/codec/interpolation.h"
#include "learn/codec/root_frame.h"
#include "learn/codec/stencil.h"

namespace wetcurl {

class Interpolator {
  public:
    // `shape` (high strands), for `rest` alone: how they lie at rest in the head's frame, where that is not
    // as drawn. `low_is_wet`, `settled`: as of RestCarrier.
    Interpolator(Interpolation kind, Stencil stencil, const Groom& high, const Groom& low,
                 const Strands* shape = nullptr, bool low_is_wet = false, const Settled* settled = nullptr);
    const Stencil& stencil() const { return stencil_; }
    const RootFrames& roots() const { return roots_; }
    // low (low strands) world positions [m], `head` the pose of the frame; out: (high strands), world.
    void apply(const Strands& low, const Pose& head, Strands& out);

  private:
    using S = Pack<float>;
    void place_means(const Strands& low, const Pose& head, Strands& out) const;
    void place_cores(const Strands& low, const Pose& head, Strands& out);
    void place_rest(const Strands& low, const Pose& head, Strands& out);
    void place_skin(const Strands& low, const Pose& head, Strands& out);

    Interpolation kind_;
    int particles_;
    Stencil stencil_;
    RootFrames roots_;
    std::optional<RestCarrier> carrier_;  // used by `rest` alone
    // Used by `core` alone: the strands, the low-resolution ones and the cores of these.
    std::optional<RootLanes> lanes_;
    std::optional<StrandLanes> low_lanes_;
    Strands cores_;
    ThreadRoom<Vec3<S>> room_;
    // Used by `skin` alone: both grooms at rest, and how the low-resolution one's particles are turned from
    // it.
    Strands rest_, low_rest_;
    std::vector<Quatf> turns_;
};

}  // namespace wetcurl
