// Counting sort of points into the cells of a regular grid.
#include "base/geometry/neighbor_grid.h"

#include <algorithm>

namespace wetcurl {

void NeighborGrid::build(const Vec3f* p, size_t count, float radius) {
    Vec3f low{0, 0, 0}, high{0, 0, 0};
    if (count) low = high = p[0];
    for (size_t i = 1; i < count; ++i) {
        low = {std::min(low.x, p[i].x), std::min(low.y, p[i].y), std::min(low.z, p[i].z)};
        high = {std::max(high.x, p[i].x), std::max(high.y, p[i].y), std::max(high.z, p[i].z)};
    }
    origin_ = low;
    // Scattered points must not cost more cells than memory: cells grow until they are a few a point.
    float side = radius;
    const double most = std::max<double>(4096, 1.5 * double(count));
    auto cells_along = [&](float extent) { return double(std::floor(extent / side)) + 1; };
    while (cells_along(high.x - low.x) * cells_along(high.y - low.y) * cells_along(high.z - low.z) > most)
        side *= 1.25f;
    inverse_ = 1 / side;
    nx_ = column(high.x) + 1;
    ny_ = cell(high.y, low.y) + 1;
    nz_ = cell(high.z, low.z) + 1;
    start_.assign(size_t(nx_) * size_t(ny_) * size_t(nz_) + 1, 0);
    order_.resize(count);
    points_.resize(count);
    for (size_t i = 0; i < count; ++i) ++start_[cell_of(p[i]) + 1];
    for (size_t c = 1; c < start_.size(); ++c) start_[c] += start_[c - 1];
    // Filling moves each start to its end, which is the next one's start: shift back afterwards.
    for (size_t i = 0; i < count; ++i) {
        const uint32_t k = start_[cell_of(p[i])]++;
        order_[k] = uint32_t(i);
        points_.set(k, p[i]);
    }
    for (size_t c = start_.size() - 1; c > 0; --c) start_[c] = start_[c - 1];
    start_[0] = 0;
}

size_t NeighborGrid::bytes() const {
    return (start_.capacity() + order_.capacity()) * sizeof(uint32_t) + points_.bytes();
}

}  // namespace wetcurl
