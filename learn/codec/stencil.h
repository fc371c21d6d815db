// Which low-resolution strands surround a high-resolution root.
// Ours; section VI.G for three roots.
#pragma once

#include <vector>

#include "base/strands.h"

namespace wetcurl {

// The low-resolution strands beside one, -1 where there is none.
struct Beside {
    int strand[4] = {-1, -1, -1, -1};
};

// For each high-resolution strand the low-resolution strands around it. Made once from the rest grooms.
struct Stencil {
    static constexpr int widest = 4;
    int width = widest;          // neighbours a strand: 4 (quad) or 3 (triangle)
    std::vector<int> from;       // (high strand, width) low strands; those unused have weight 0
    std::vector<float> weight;   // (high strand, width), summing to one
    std::vector<int> nearest;    // (high strand) the low strand with the nearest root
    std::vector<int> twin;       // (low strand) the high strand that it is, -1: none of them
    std::vector<Beside> beside;  // (low strand)

    int count() const { return int(nearest.size()); }
};

// Throws Error, naming the first strand that differs, unless `low` is every second root each way of `high`.
void require_nested(const Groom& high, const Groom& low);
// For each strand of `low` that of `high` which is the same, -1: none of them. As many particles in both.
std::vector<int> twins_of(const Groom& high, const Groom& low);
// Throws Error, naming the first strand, unless each of `low` is one of `high`, wherever.
void require_part(const Groom& high, const Groom& low);
// Whether `low` is every k-th root each way of `high`, for some k.
bool nests(const Groom& high, const Groom& low);

// The surrounding four on the root grid, bilinear. Where the grid has a hole or ends, the others share its
// weight; where it has none at all, the nearest root stands alone. Throws Error unless `low` nests in `high`.
Stencil quad_stencil(const Groom& high, const Groom& low);
// The three roots around each, of the nearest eight the smallest triangle that holds it, by barycentric
// coordinates in the scalp's tangent plane; where none does, the nearest three, cut off at zero: needs no
// grid.
Stencil triangle_stencil(const Groom& high, const Groom& low);
// That of the grid where `low` nests in `high`, else triangles.
Stencil surrounding_stencil(const Groom& high, const Groom& low);

}  // namespace wetcurl
