// Neighbours within a radius on a device: particles in the order of their cells, in a grid that wraps round.
// A thread a particle; cuda/cell_search_device.h has the buffers and launches. Ours.
#pragma once

#include <cmath>
#include <cstdint>

#include "base/vec3.h"

namespace wetcurl {

// No bounds to find, and the 27 cells about a point are always 27 cells. What comes from far away is turned
// down by its distance. Sides are powers of two, at least those of a brick.
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
    // By bricks of 8 x 4 x 4 cells, so that what follows each other in the order lies together.
    WETCURL_HD uint32_t key(int cx, int cy, int cz) const {
        const uint32_t x = uint32_t(cx) & ((1u << bits_x) - 1), y = uint32_t(cy) & ((1u << bits_y) - 1),
                       z = uint32_t(cz) & ((1u << bits_z) - 1);
        const uint32_t brick = (((z >> 2 << (bits_y - 2)) | y >> 2) << (bits_x - 3)) | x >> 3;
        return brick << 7 | (z & 3) << 5 | (y & 3) << 3 | (x & 7);
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
    WrappedGrid grid{3, 2, 2, float(1 / (1.001 * radius))};
    for (int k = 0; grid.cells() < particles; ++k)
        ++(k % 3 == 0 ? grid.bits_y : k % 3 == 1 ? grid.bits_z : grid.bits_x);
    return grid;
}

struct alignas(16) SortedPoint {
    float x, y, z;
    uint32_t id;
    WETCURL_HD Vec3f position() const { return {x, y, z}; }
};
struct CellRange {
    uint32_t begin, end;
};
inline constexpr uint32_t no_particle = 0xffffffffu;  // begin of an empty cell

// A view of the search's arrays. Particle `id` is of strand id / particles.
struct CellSearch {
    uint32_t count;
    int particles;                     // a strand
    uint32_t *key, *id;                // (strand, particle)
    uint32_t *sorted_key, *sorted_id;  // in the order of cells; what has none comes last
    SortedPoint* sorted;
    CellRange* cell;  // (cells)
    WrappedGrid grid;
    Vec3f origin;  // of the cells
    float radius;

    // Before the sort by key, where all cells become empty ones too.
    WETCURL_HD void place(uint32_t particle, const Vec3f& p) const {
        key[particle] = grid.key_of(p - origin), id[particle] = particle;
    }
    WETCURL_HD void empty_cell(uint32_t k) const { cell[k] = {no_particle, no_particle}; }
    // After it: sorted particle k, at p, finds where its cell begins or ends.
    WETCURL_HD void mark_cell(uint32_t k, const Vec3f& p) const {
        sorted[k] = {p.x, p.y, p.z, sorted_id[k]};
        const uint32_t own = sorted_key[k];
        if (own == grid.cells()) return;
        if (k == 0 || sorted_key[k - 1] != own) cell[own].begin = k;
        if (k + 1 == count || sorted_key[k + 1] != own) cell[own].end = k + 1;
    }

    // Calls visit(k, sorted[k]) for each sorted particle k nearer to p than the radius on another strand than
    // particle `of` (`count`: on any), always in the same order.
    template <class Visit>
    WETCURL_HD void neighbours(uint32_t of, const Vec3f& p, Visit visit) const {
        const Vec3f from = p - origin;
        if (!grid.holds(from)) return;
        const auto c = grid.cell_of(from);
        const uint32_t own = of - of % uint32_t(particles);
        auto search = [&](uint32_t begin, uint32_t end) {
            for (uint32_t k = begin; k < end; ++k) {
                const SortedPoint other = sorted[k];
                const Vec3f d = other.position() - p;
                if (dot(d, d) < radius * radius && other.id - own >= uint32_t(particles)) visit(k, other);
            }
        };
        for (int z = c.z - 1; z <= c.z + 1; ++z)
            for (int y = c.y - 1; y <= c.y + 1; ++y) {
                // Cells along x lie side by side in the order, within a brick.
                uint32_t begin = 0, end = 0;
                for (int x = c.x - 1; x <= c.x + 1; ++x) {
                    const CellRange range = cell[grid.key(x, y, z)];
                    if (range.begin == no_particle) continue;
                    if (range.begin != end) search(begin, end), begin = range.begin;
                    end = range.end;
                }
                search(begin, end);
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
