// Which low-resolution strands surround a high-resolution root.
// Ours; section VI.G for three roots.
#pragma once

#include <vector>

#include "base/strands.h"

namespace wetcurl {

// For each high-resolution strand the low-resolution strands around it. Made once from the rest grooms.
struct Stencil {
    static constexpr int widest = 4;
    int width = widest;         // neighbours a strand: 4 (quad) or 3 (triangle)
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

}  // namespace wetcurl
