// Neighbours within a radius: points sorted by the cell of a uniform grid (counting sort). Ours.
#pragma once

#include <cstdint>
#include <vector>

#include "base/vec3.h"

namespace wetcurl {

// Points in the order of their cells; `order[k]` is the index of sorted point k in the input.
// Buffers keep their memory from one build to the next.
class NeighborGrid {
  public:
    // `positions` (count) [m]; cells have the side of `radius` [m].
    void build(const Vec3f* positions, size_t count, float radius);
    const std::vector<uint32_t>& order() const { return order_; }
    const std::vector<Vec3f>& sorted() const { return sorted_; }
    size_t bytes() const;

    // Calls visit(k) for each sorted point k in the 27 cells around x (the caller tests the distance).
    // x may lie anywhere.
    template <class Visit>
    void around(const Vec3f& x, Visit visit) const {
        const int cx = cell(x.x, origin_.x), cy = cell(x.y, origin_.y), cz = cell(x.z, origin_.z);
        const int x0 = cx > 0 ? cx - 1 : 0, x1 = cx + 1 < nx_ ? cx + 1 : nx_ - 1;
        if (x0 > x1) return;
        for (int z = cz > 0 ? cz - 1 : 0; z <= cz + 1 && z < nz_; ++z)
            for (int y = cy > 0 ? cy - 1 : 0; y <= cy + 1 && y < ny_; ++y) {
                const size_t row = (size_t(z) * size_t(ny_) + size_t(y)) * size_t(nx_);
                for (uint32_t k = start_[row + size_t(x0)], end = start_[row + size_t(x1) + 1]; k < end; ++k)
                    visit(k);
            }
    }

  private:
    int cell(float x, float origin) const {
        const float c = std::floor((x - origin) * inverse_);
        return c < -2 ? -2 : c > 1e6f ? 1000000 : int(c);
    }
    Vec3f origin_{0, 0, 0};
    float inverse_ = 1;
    int nx_ = 0, ny_ = 0, nz_ = 0;
    std::vector<uint32_t> start_, order_, cell_of_;
    std::vector<Vec3f> sorted_;
};

}  // namespace wetcurl
