// Counting sort of points into the cells of a regular grid.
#include "base/geometry/neighbor_grid.h"

#include <omp.h>

#include <algorithm>
#include <limits>

namespace wetcurl {

void NeighborGrid::build(const Vec3f* p, size_t count, float radius) {
    constexpr float all = std::numeric_limits<float>::infinity();
    float lx = all, ly = all, lz = all, hx = -all, hy = -all, hz = -all;
#pragma omp parallel for schedule(static) reduction(min : lx, ly, lz) reduction(max : hx, hy, hz)
    for (size_t i = 0; i < count; ++i) {
        lx = std::min(lx, p[i].x), ly = std::min(ly, p[i].y), lz = std::min(lz, p[i].z);
        hx = std::max(hx, p[i].x), hy = std::max(hy, p[i].y), hz = std::max(hz, p[i].z);
    }
    const Vec3f low = count ? Vec3f{lx, ly, lz} : Vec3f{0, 0, 0},
                high = count ? Vec3f{hx, hy, hz} : Vec3f{0, 0, 0};
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
    // Each thread looks at all points and takes those of its cells, so that they keep their order.
    const size_t cells = start_.size() - 1;
    std::vector<size_t> first_cell;  // (thread and one), each with about as many points
#pragma omp parallel
    {
        const size_t thread = size_t(omp_get_thread_num()), threads = size_t(omp_get_num_threads());
        const auto for_each_in = [&](size_t begin, size_t end, auto take) {
            for (size_t i = 0; i < count; ++i) {
                const size_t cell = cell_of(p[i]);
                if (cell - begin < end - begin) take(i, cell);
            }
        };
        for_each_in(cells * thread / threads, cells * (thread + 1) / threads,
                    [&](size_t, size_t cell) { ++start_[cell + 1]; });
#pragma omp barrier
#pragma omp single
        {
            for (size_t c = 1; c <= cells; ++c) start_[c] += start_[c - 1];
            for (size_t t = 0; t < threads; ++t)
                first_cell.push_back(
                    size_t(std::lower_bound(start_.begin(), start_.end() - 1, count * t / threads) -
                           start_.begin()));
            first_cell[0] = 0, first_cell.push_back(cells);
        }
        // Filling moves each start to its end, which is the next one's start: shift back afterwards.
        for_each_in(first_cell[thread], first_cell[thread + 1], [&](size_t i, size_t cell) {
            const uint32_t k = start_[cell]++;
            order_[k] = uint32_t(i);
            points_.set(k, p[i]);
        });
    }
    for (size_t c = start_.size() - 1; c > 0; --c) start_[c] = start_[c - 1];
    start_[0] = 0;
}

size_t NeighborGrid::bytes() const {
    return (start_.capacity() + order_.capacity()) * sizeof(uint32_t) + points_.bytes();
}

}  // namespace wetcurl
