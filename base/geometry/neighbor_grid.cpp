// Counting sorts.
#include "base/geometry/neighbor_grid.h"

#include <omp.h>

#include <algorithm>
#include <bit>
#include <limits>
#include <utility>

namespace wetcurl {

namespace {

// put(i, k) for i = 0 .. count - 1, k its place among all by key(i) < bins; equal ones keep their order.
// `start` (bins + 1): where a bin's places begin. `next`: scratch.
template <class Key, class Put>
void counting_sort(size_t count, size_t bins, std::vector<uint32_t>& start, std::vector<uint32_t>& next,
                   Key key, Put put) {
    // Threads count on their own: few, where there are many bins.
    const int most = int(std::min<size_t>(size_t(omp_get_max_threads()), 1 + 2 * count / bins));
    // With room for points that spread a little.
    const size_t room = size_t(most) * bins;
    if (next.capacity() < room) next.reserve(room + room / 2);
    if (start.capacity() < bins + 1) start.reserve(bins + bins / 2 + 1);
    next.assign(room, 0), start.resize(bins + 1);
#pragma omp parallel num_threads(most)
    {
        const size_t thread = size_t(omp_get_thread_num()), threads = size_t(omp_get_num_threads()),
                     low = count * thread / threads, high = count * (thread + 1) / threads;
        uint32_t* mine = &next[thread * bins];
        for (size_t i = low; i < high; ++i) ++mine[key(i)];
#pragma omp barrier
#pragma omp single
        {
            uint32_t sum = 0;
            for (size_t bin = 0; bin < bins; ++bin) {
                start[bin] = sum;
                for (size_t t = 0; t < threads; ++t) {
                    uint32_t& place = next[t * bins + bin];
                    sum += std::exchange(place, sum);
                }
            }
            start[bins] = sum;
        }
        for (size_t i = low; i < high; ++i) put(i, mine[key(i)]++);
    }
}

}  // namespace

void NeighborGrid::build(const Vec3f* p, size_t count, float radius, const std::vector<float>* weight) {
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
    // Scattered points must not cost more rows than there are points: rows widen until they are fewer.
    float side = radius;
    const double most = std::max<double>(4096, double(count));
    auto cells_along = [&](float extent) { return double(std::floor(extent / side)) + 1; };
    while (cells_along(high.x - low.x) * cells_along(high.z - low.z) > most) side *= 1.25f;
    inverse_ = 1 / side;
    nx_ = cell(high.x, low.x) + 1;
    nz_ = cell(high.z, low.z) + 1;
    const float width = std::max(radius / 8, 1.001f * (high.y - low.y) / most_columns);
    per_column_ = 1 / width;
    reach_ = int(std::ceil(radius / width)) + 1;

    parts_ = weight ? 2 : 1;
    points_.resize(count);
    // The first sort's order waits in the place of the points' numbers.
    counting_sort(
        count, size_t(column(high.y)) + 1, start_, next_, [&](size_t i) { return size_t(column(p[i].y)); },
        [&](size_t i, uint32_t k) { points_.number(k) = std::bit_cast<float>(uint32_t(i)); });
    const auto by_column = [&](size_t k) { return std::bit_cast<uint32_t>(points_.number(k)); };
    order_.resize(count), column_.resize(count);
    counting_sort(
        count, parts_ * size_t(nx_) * size_t(nz_), start_, next_,
        [&](size_t i) {
            const size_t k = by_column(i), row = first_part(row_of(p[k]));
            return weight && !((*weight)[k] > 0) ? row + 1 : row;
        },
        [&](size_t i, uint32_t k) { order_[k] = by_column(i); });
#pragma omp parallel for schedule(static)
    for (size_t k = 0; k < count; ++k) {
        points_.set(k, p[order_[k]]);
        column_[k] = uint16_t(column(points_.at(k).y));
    }
}

size_t NeighborGrid::bytes() const {
    return (start_.capacity() + order_.capacity() + next_.capacity()) * sizeof(uint32_t) +
           column_.capacity() * sizeof(uint16_t) + points_.bytes();
}

}  // namespace wetcurl
