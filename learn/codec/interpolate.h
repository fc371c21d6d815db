// A low-resolution run brought to every high-resolution root, without a network: the rows that a learned
// result is judged against. A strand is
// moved rigidly from its own root to the new one (offsets in world axes): turning it with the root frames as
// well would turn its droop away from gravity. Roots come from the rest groom and the head's pose, so they
// are exact.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "learn/codec/carried_rest.h"
#include "learn/codec/root_frame.h"
#include "learn/codec/stencil.h"

namespace wetcurl {

// nearest: a copy of the nearest strand; quad: the weighted mean; core: the weighted mean of the cores (Form
// V+), with the nearest strand's detail in the core's frames; rest: the strand's own rest shape, whose core
// is moved as those around it have moved from theirs, with its own detail in the core's frames.
enum class Interpolation { nearest, quad, core, rest };
// Throws Misuse for another name.
Interpolation interpolation_named(const std::string& name);

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
    Interpolation kind_;
    Stencil stencil_;
    RootFrames roots_;
    Strands cores_;                       // of the low strands; used by `core` alone
    std::optional<RestCarrier> carrier_;  // used by `rest` alone
};

}  // namespace wetcurl
