// Neighbours within a radius on a device: particles in the order of their cells, in a grid that wraps round.
// A thread a particle; cuda/device/cell_search_device.h has the buffers and launches.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/vec3.h"

namespace wetcurl {

// No bounds to find, and the 27 cells about a point are always 27 cells. What comes from far away is turned
// down by its distance. Sides are powers of two, at least 4.
struct WrappedGrid {
    int bits_x, bits_y, bits_z;
    float inverse;  // of the cells' side [1/m]
    WETCURL_HD uint32_t cells() const { return 1u << (bits_x + bits_y + bits_z); }

    struct Cell {
        int x, y, z;
    };
    WETCURL_HD Cell cell_of(const Vec3f& x) const {
        return {int(std::floor(x.x * inverse)), int(std::floor(x.y * inverse)),
                int(std::floor(x.z * inverse))};
    }
    // Whether x [m, from the grid's origin] has a cell: not where it is not finite or absurdly far.
    WETCURL_HD bool holds(const Vec3f& x) const {
        return (std::abs(x.x) + std::abs(x.y) + std::abs(x.z)) * inverse < 1e9f;  // false for NaN
    }
    WETCURL_HD uint32_t key(int cx, int cy, int cz) const {
        const uint32_t x = uint32_t(cx) & ((1u << bits_x) - 1), y = uint32_t(cy) & ((1u << bits_y) - 1),
                       z = uint32_t(cz) & ((1u << bits_z) - 1);
        return (((z << bits_y) | y) << bits_x) | x;
    }
    // `cells()` where x has none.
    WETCURL_HD uint32_t key_of(const Vec3f& x) const {
        if (!holds(x)) return cells();
        const Cell c = cell_of(x);
        return key(c.x, c.y, c.z);
    }
};
// Of at least as many cells as particles, their side `radius` and a little: rounding must not hide a
// neighbour.
inline WrappedGrid wrapped_grid(size_t particles, double radius) {
    WrappedGrid grid{2, 2, 2, float(1 / (1.001 * radius))};
    for (int k = 0; grid.cells() < particles; ++k)
        ++(k % 3 == 0 ? grid.bits_x : k % 3 == 1 ? grid.bits_y : grid.bits_z);
    return grid;
}

struct alignas(16) SortedPoint {
    float x, y, z;
    uint32_t id;
    WETCURL_HD Vec3f position() const { return {x, y, z}; }
};
// A view of the search's arrays. Particle `id` is of strand id / particles.
struct CellSearch {
    static constexpr uint32_t at_once = 4;  // are read together
    uint32_t count;
    int particles;         // a strand
    uint32_t* rank;        // (strand, particle): how many came to its cell before
    uint32_t* start;       // (cells + 2) in the order; what has no cell comes last, then `count`
    SortedPoint* arrived;  // (count) by cells, in each as they came
    // The order: by cells, in each by their numbers; what has no cell, as it came.
    uint32_t* sorted_id;
    SortedPoint* sorted;  // (count + at_once - 1): what follows the last is read and never near
    WrappedGrid grid;
    Vec3f origin;  // of the cells
    float radius;

    // `grid.cells()` where p has none.
    WETCURL_HD uint32_t cell_of(const Vec3f& p) const { return grid.key_of(p - origin); }
    // First, where `start` is 0: each particle counts. add(shared, 1) tells what `shared` was before.
    template <class Add>
    WETCURL_HD void count_in(uint32_t particle, const Vec3f& p, Add add) const {
        rank[particle] = add(start[cell_of(p)], 1u);
    }
    // Once `start` sums up those before each cell.
    WETCURL_HD void arrive(uint32_t particle, const Vec3f& p) const {
        arrived[start[cell_of(p)] + rank[particle]] = {p.x, p.y, p.z, particle};
    }
    // Once all have arrived: the k-th of them takes its place, which in a cell does not hang on who came
    // first. Looks at all in its cell.
    WETCURL_HD void settle(uint32_t k) const {
        const SortedPoint p = arrived[k];
        const uint32_t own = cell_of(p.position());
        uint32_t at = k;
        if (own < grid.cells()) {
            at = start[own];
            for (uint32_t j = at; j < start[own + 1]; ++j) at += arrived[j].id < p.id;
        }
        sorted_id[at] = p.id, sorted[at] = p;
    }

    // Calls candidate(near, k, sorted[k]) for k from begin to end, a few at a time: `near` for each that is
    // nearer to p than `distance` on another strand than particle `of`.
    template <class Candidate>
    WETCURL_HD void look(uint32_t of, const Vec3f& p, float distance, uint32_t begin, uint32_t end,
                         Candidate candidate) const {
        const uint32_t own = of - of % uint32_t(particles);
        for (uint32_t k = begin; k < end; k += at_once) {
            SortedPoint other[at_once];
            for (uint32_t l = 0; l < at_once; ++l) other[l] = sorted[k + l];
            for (uint32_t l = 0; l < at_once; ++l) {
                const Vec3f d = other[l].position() - p;
                // All three, whatever the first says: a branch takes longer.
                candidate(bool((l == 0 || k + l < end) & (dot(d, d) < distance * distance) &
                               (other[l].id - own >= uint32_t(particles))),
                          k + l, other[l]);
            }
        }
    }
    // Calls candidate(near, k, sorted[k]) for sorted particles k around p, always in the same order: `near`
    // for each that is nearer to p than the radius on another strand than particle `of` (`count`: on any).
    // Where it is false, k may be count and more.
    template <class Candidate>
    WETCURL_HD void candidates(uint32_t of, const Vec3f& p, Candidate candidate) const {
        const Vec3f from = p - origin;
        if (!grid.holds(from)) return;
        const auto c = grid.cell_of(from);
        auto search = [&](uint32_t begin, uint32_t end) { look(of, p, radius, begin, end, candidate); };
        // Nine rows of three cells along x, which lie side by side in the order, but where the grid wraps
        // round: then they lie in two places. Those of the next row are asked for before one is gone through.
        const uint32_t width = 1u << grid.bits_x, left = uint32_t(c.x - 1) & (width - 1),
                       right = left + 3 < width ? left + 3 : width, over = left + 3 - right;
        uint32_t begin = 0, end = 0, begin_over = 0, end_over = 0;
        auto look_up = [&](int row) {
            const uint32_t* const of_row = start + grid.key(0, c.y - 1 + row % 3, c.z - 1 + row / 3);
            begin = of_row[left], end = of_row[right];
            if (over > 0) begin_over = of_row[0], end_over = of_row[over];
        };
        look_up(0);
        for (int row = 0; row < 9; ++row) {
            const uint32_t from_k = begin, to_k = end, from_over = begin_over, to_over = end_over;
            if (row < 8) look_up(row + 1);
            search(from_k, to_k);
            if (over > 0) search(from_over, to_over);
        }
    }
    // Calls visit(k, sorted[k]) for each who is near.
    template <class Visit>
    WETCURL_HD void neighbours(uint32_t of, const Vec3f& p, Visit visit) const {
        candidates(of, p, [&](bool near, uint32_t k, const SortedPoint& other) {
            if (near) visit(k, other);
        });
    }
    // Calls visit(k, sorted[k]) for each that is nearer to p than `distance` on another strand than particle
    // `of`, always in the same order. However many cells that is.
    template <class Visit>
    WETCURL_HD void within(uint32_t of, const Vec3f& p, float distance, Visit visit) const {
        const Vec3f from = p - origin, way{distance, distance, distance};
        if (!grid.holds(from)) return;
        const auto low = grid.cell_of(from - way), high = grid.cell_of(from + way);
        const uint32_t width = 1u << grid.bits_x;
        auto search = [&](uint32_t begin, uint32_t end) {
            look(of, p, distance, begin, end, [&](bool near, uint32_t k, const SortedPoint& other) {
                if (near) visit(k, other);
            });
        };
        // The grid wraps round: no cell is seen twice.
        auto cells = [](int from_cell, int to_cell, int bits) {
            return minimum(to_cell - from_cell + 1, 1 << bits);
        };
        const uint32_t left = uint32_t(low.x) & (width - 1),
                       many = uint32_t(cells(low.x, high.x, grid.bits_x)),
                       right = left + many < width ? left + many : width, over = left + many - right;
        for (int z = cells(low.z, high.z, grid.bits_z); z-- > 0;)
            for (int y = cells(low.y, high.y, grid.bits_y); y-- > 0;) {
                const uint32_t* const of_row = start + grid.key(0, low.y + y, low.z + z);
                search(of_row[left], of_row[right]);
                if (over > 0) search(of_row[0], of_row[over]);
            }
    }
    // Whether test(cell) holds of a cell around p.
    template <class Test>
    WETCURL_HD bool any_cell(const Vec3f& p, Test test) const {
        const Vec3f from = p - origin;
        if (!grid.holds(from)) return false;
        const auto c = grid.cell_of(from);
        for (int z = c.z - 1; z <= c.z + 1; ++z)
            for (int y = c.y - 1; y <= c.y + 1; ++y)
                for (int x = c.x - 1; x <= c.x + 1; ++x)
                    if (test(grid.key(x, y, z))) return true;
        return false;
    }
    // Calls visit(j, r) for each particle j that sorted particle `own` finds on other strands, r [m] away.
    template <class Visit>
    WETCURL_HD void contacts(const SortedPoint& own, Visit visit) const {
        neighbours(own.id, own.position(), [&](uint32_t, const SortedPoint& other) {
            const Vec3f d = other.position() - own.position();
            visit(size_t(other.id), std::sqrt(double(dot(d, d))));
        });
    }
};

}  // namespace wetcurl
