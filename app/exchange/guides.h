// Guides: few strands of a groom that stand for all of it, and which of them each strand follows.
#pragma once

#include <array>
#include <vector>

#include "base/vec3.h"

namespace wetcurl {

struct Guides {
    std::vector<int> strands;                   // (guide): its strand, in rising order
    std::vector<std::array<int, 3>> nearest;    // (strand): strands that are guides, the nearest first
    std::vector<std::array<float, 3>> weights;  // (strand): of these; their sum is 1
};

// `count` guides among the strands with these roots [m], spread evenly: each next one is the root that is
// farthest from those there are (Gonzalez 1985). Weights fall with the inverse distance of roots; a guide
// follows itself alone. Throws Misuse where count is below 1 or above the number of strands.
Guides guides_of(const std::vector<Vec3f>& roots, int count);

}  // namespace wetcurl
