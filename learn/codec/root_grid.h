// Which pixel of the root grid a strand is at.
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "base/strands.h"

namespace wetcurl {

// row * width + column of each of `strands` strands. Throws Error where one has no pixel.
inline std::vector<int> pixels_of_strands(const RootGrid& grid, int strands) {
    std::vector<int> out(size_t(strands), -1);
    for (size_t pixel = 0; pixel < grid.strand.size(); ++pixel)
        if (int s = grid.strand[pixel]; s >= 0 && s < strands) out[size_t(s)] = int(pixel);
    for (int s = 0; s < strands; ++s)
        if (out[size_t(s)] < 0)
            throw Error("root grid: strand " + std::to_string(s) +
                        " is at no pixel, allowed one for each strand");
    return out;
}

}  // namespace wetcurl
