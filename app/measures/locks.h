// Locks: how wide the hair is that each gathers, and how wide it is drawn.
#pragma once

#include "base/strands.h"

namespace wetcurl {

// Means over locks of three strands or more.
struct Locks {
    double gathered = 0;         // width of the hair, before it was drawn together [m]
    double drawn = 0, tips = 0;  // width of the lock, at two thirds of the strands and near their tips [m]
    double strands = 0;          // in a lock
    double share = 0;            // of the strands, that lie in such a lock
};

// `simulated` strands were drawn together to `displayed` ones. The lock of a strand: all of which some
// particle is displayed within `reach` [m] of it, at two thirds of its length or near its tip. A width is
// four times the standard deviation across the strand: the diameter of a disc of even density.
Locks locks_of(const Strands& simulated, const Strands& displayed, float reach);

}  // namespace wetcurl
