// The part of a root grid for which a network is asked.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/strands.h"

namespace wetcurl {

struct GridBox {
    int row = 0, column = 0, height = 0, width = 0;
};

// `answered` has the strands that are wanted; what the network looks at for these is in `seen`.
struct Crop {
    GridBox answered, seen;
};

// wanted (strand of the grid): 0 or 1; none gives empty boxes. reach: as of Network::reach, of a network of
// that architecture. Throws Error where the reach has no end, or where there is no number for a strand.
Crop crop_to(const RootGrid& grid, const std::vector<uint8_t>& wanted, int reach,
             const std::string& architecture);

}  // namespace wetcurl
