// A low-resolution run brought to every high-resolution root, without a network: the rows that a learned
// result is judged against, and the base that it starts from. Ours; section VI.G for three roots. A strand is
// moved rigidly from its own root to the new one (offsets in world axes): turning it with the root frames as
// well would turn its droop away from gravity. Roots come from the rest groom and the head's pose, so they
// are exact.
#pragma once

#include <string>
#include <vector>

#include "learn/root_frame.h"

namespace wetcurl {

// For each high-resolution strand the low-resolution strands around it. Made once from the rest grooms.
struct Stencil {
    int width = 4;              // neighbours a strand: 4 (quad) or 3 (triangle)
    std::vector<int> from;      // (high strand, width) low strands; those unused have weight 0
    std::vector<float> weight;  // (high strand, width), summing to one
    std::vector<int> nearest;   // (high strand) the low strand with the nearest root
    std::vector<int> twin;      // (low strand) the high strand with the same root

    int count() const { return int(nearest.size()); }
};

// Throws Error, naming the first strand that differs, unless `low` is every second root each way of `high`.
void require_nested(const Groom& high, const Groom& low);

// The surrounding four on the root grid, bilinear: 1, 1/2 + 1/2 or four quarters. Where the grid has a hole
// or ends, the others share its weight; where it has none at all, the nearest root stands alone.
Stencil quad_stencil(const Groom& high, const Groom& low);
// The three nearest roots, by barycentric coordinates in the scalp's tangent plane, cut off at zero: needs no
// grid.
Stencil triangle_stencil(const Groom& high, const Groom& low);

// nearest: a copy of the nearest strand; quad: the weighted mean; core: the weighted mean of the cores (Form
// V+), with the nearest strand's detail in the core's frames; rest: the strand's own rest shape, whose core
// is moved as those around it have moved from theirs, with its own detail in the core's frames.
enum class Interpolation { nearest, quad, core, rest };
// Throws Misuse for another name.
Interpolation interpolation_named(const std::string& name);

class Interpolator {
  public:
    // `shape` (high strands), for `rest` alone: how they lie at rest in the head's frame, where that is not
    // as drawn.
    Interpolator(Interpolation kind, Stencil stencil, const Groom& high, const Groom& low,
                 const Strands* shape = nullptr);
    const Stencil& stencil() const { return stencil_; }
    const RootFrames& roots() const { return roots_; }
    // low (low strands) world positions [m], `head` the pose of the frame; out: (high strands), world.
    void apply(const Strands& low, const Pose& head, Strands& out);

  private:
    Interpolation kind_;
    Stencil stencil_;
    RootFrames roots_;
    Strands cores_;  // of the low strands; used by `core` and `rest` alone
    // Used by `rest` alone, all at rest in the head's frame.
    Strands rest_, rest_cores_, detail_cores_, low_rest_cores_;
};

}  // namespace wetcurl
