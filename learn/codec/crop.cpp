// The part of a root grid for which a network is asked.
#include "learn/codec/crop.h"

#include <algorithm>

#include "base/error.h"

namespace wetcurl {

namespace {

// All within `reach` pixels of a box, as far as the grid goes.
GridBox grown(const GridBox& box, int reach, const RootGrid& grid) {
    const int row = std::max(box.row - reach, 0), column = std::max(box.column - reach, 0);
    return {row, column, std::min(box.row + box.height + reach, grid.height) - row,
            std::min(box.column + box.width + reach, grid.width) - column};
}

}  // namespace

Crop crop_to(const RootGrid& grid, const std::vector<uint8_t>& wanted, int reach,
             const std::string& architecture) {
    if (reach < 0)
        throw Error("network " + architecture +
                    ": looks at the whole grid, allowed for a crop is one that looks at some pixels around");
    int first = grid.height, last = -1, left = grid.width, right = -1;
    for (int row = 0; row < grid.height; ++row)
        for (int column = 0; column < grid.width; ++column) {
            const int s = grid.strand[size_t(row) * size_t(grid.width) + size_t(column)];
            if (s < 0) continue;
            if (size_t(s) >= wanted.size())
                throw Error("crop: found " + std::to_string(wanted.size()) +
                            " strands wanted or not, allowed one for each, strand " + std::to_string(s) +
                            " too");
            if (!wanted[size_t(s)]) continue;
            first = std::min(first, row), last = std::max(last, row);
            left = std::min(left, column), right = std::max(right, column);
        }
    if (last < 0) return {};
    const GridBox answered{first, left, last + 1 - first, right + 1 - left};
    return {answered, grown(answered, reach, grid)};
}

}  // namespace wetcurl
