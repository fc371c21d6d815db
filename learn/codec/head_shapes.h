// What learned strands of a head are kept out of.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "base/geometry/shapes.h"

namespace wetcurl {

// What is attached to the head, in its frame, and how deep each particle may lie in it, 0 or as deep as at
// rest, below 0: (high strand, particle) [m].
struct HeadShapes {
    std::vector<Shape> shapes;
    std::vector<float> depth;
};
// Throws Error unless there is a depth for each of so many particles.
inline void require_each(const HeadShapes& head, size_t particles) {
    if (head.depth.size() != particles)
        throw Error(
            "learned strands: found " + std::to_string(head.depth.size()) +
            " depths in what is attached to the head, allowed one a particle: " + std::to_string(particles));
}

}  // namespace wetcurl
