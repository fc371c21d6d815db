// Neighbours within a radius on a device: particles in the order of their cells, in a grid that wraps round.
// A thread a particle; cuda/cell_search_device.h has the buffers and launches. Ours.
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
struct CellRange {
    uint32_t begin, end;
};
inline constexpr uint32_t no_particle = 0xffffffffu;  // begin of an empty cell

// A view of the search's arrays. Particle `id` is of strand id / particles.
struct CellSearch {
    static constexpr uint32_t at_once = 4;  // are read together
    uint32_t count;
    int particles;                     // a strand
    uint32_t *key, *id;                // (strand, particle)
    uint32_t *sorted_key, *sorted_id;  // in the order of cells; what has none comes last
    SortedPoint* sorted;               // (count + at_once - 1): what follows the last is read and never near
    CellRange* cell;                   // (cells)
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

    // Calls candidate(near, k, sorted[k]) for sorted particles k around p, always in the same order: `near`
    // for each that is nearer to p than the radius on another strand than particle `of` (`count`: on any).
    // Where it is false, k may be count and more.
    template <class Candidate>
    WETCURL_HD void candidates(uint32_t of, const Vec3f& p, Candidate candidate) const {
        const Vec3f from = p - origin;
        if (!grid.holds(from)) return;
        const auto c = grid.cell_of(from);
        const uint32_t own = of - of % uint32_t(particles);
        auto search = [&](uint32_t begin, uint32_t end) {
            for (uint32_t k = begin; k < end; k += at_once) {
                SortedPoint other[at_once];
                for (uint32_t l = 0; l < at_once; ++l) other[l] = sorted[k + l];
                for (uint32_t l = 0; l < at_once; ++l) {
                    const Vec3f d = other[l].position() - p;
                    // All three, whatever the first says: a branch takes longer.
                    candidate(bool((l == 0 || k + l < end) & (dot(d, d) < radius * radius) &
                                   (other[l].id - own >= uint32_t(particles))),
                              k + l, other[l]);
                }
            }
        };
        for (int z = c.z - 1; z <= c.z + 1; ++z)
            for (int y = c.y - 1; y <= c.y + 1; ++y) {
                // Cells along x lie side by side in the order, but where the grid wraps round.
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
    // Calls visit(k, sorted[k]) for each who is near.
    template <class Visit>
    WETCURL_HD void neighbours(uint32_t of, const Vec3f& p, Visit visit) const {
        candidates(of, p, [&](bool near, uint32_t k, const SortedPoint& other) {
            if (near) visit(k, other);
        });
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
