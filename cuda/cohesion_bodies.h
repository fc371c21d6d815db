// Eq 10 on a device, particle by particle: neighbours, displacements, and where a particle is shown. The
// formulas are those of solver/terms/cohesion.h; the reference is solver/passes/cohesion.h. Ours.
#pragma once

#include <cstdint>

#include "base/geometry/filter.h"
#include "cuda/cell_search.h"
#include "solver/passes/contact.h"
#include "solver/passes/thinning.h"
#include "solver/terms/cohesion.h"

namespace wetcurl {

// Where a particle is, and V = m / rho: read at once.
struct alignas(16) HairPoint {
    float x, y, z, volume;
    WETCURL_HD Vec3f position() const { return {x, y, z}; }
};
// How far a pass moves a particle, before that is smoothed along its strand, and where it is in the order.
struct alignas(16) Displaced {
    float x, y, z;
    uint32_t rank;
};
// Where it is shown, and how long the edge to it was simulated.
struct alignas(16) ShownPoint {
    float x, y, z, length;
    WETCURL_HD Vec3f position() const { return {x, y, z}; }
};
// So many that follow each other in the order of cells are a tile. What it sees, at most so many, takes a
// third of a processor's own memory.
constexpr int tile_particles = 256, most_seen = 3711;
// The lists of a tile, in rows of the lists' memory: first the ranks of those that it sees, from `row` on,
// then groups, whose entries count among these. Of one that would see too many there are groups alone, whose
// entries are ranks. no_list: nobody of it has a neighbour.
struct Tile {
    uint32_t row, seen;
};
inline constexpr uint32_t too_many = 0xffffffffu, no_list = 0xffffffffu;
// Neighbour lists of 32 of a tile: four entries a lane from `row` on, of 2 bytes, then from the next row,
// `rows` times; where they are ranks, of 4 bytes, they take two rows each time.
struct ListGroup {
    uint32_t row, rows;
};
// Numbers of 4 bytes.
constexpr uint32_t list_row = 64;

// Where not all particles of a strand are asked, those who are count from its root as all of them would.
struct CohesionMemory {
    CellSearch search;  // within Eq 10's h
    // In the order of cells, and one more who is nobody, without volume.
    HairPoint* point;
    float* wet_volume;  // sigma V
    uint8_t* wet_cell;  // (cells) whether a wet particle lies there; null where all are wet
    Tile* tile;         // (tiles)
    ListGroup* group;   // (tiles, 8)
    uint8_t* who;       // (tiles, 256) of its tile's particles a lane takes
    uint32_t* list;  // rows of list_row; lists are filled up with nobody, who follows the last that is seen
    Displaced* displaced;      // (strand, particle)
    float *beta, *own_weight;  // (strand) of the smoothing; Eq 10's own_weight
    const float* own_volume;   // (strand, particle) of itself, null: V is
};

struct CohesionBodies {
    Cohesion term;
    Thinning thinning;
    CohesionMemory m;

    // `length` [m] of the strand, `asked` of the line through those who are asked.
    WETCURL_HD void measure(int strand, double length, double asked) const {
        const float segment = float(length / (thinning.particles - 1)),
                    between = float(asked / (m.search.particles - 1));
        m.own_weight[strand] = float(term.own_weight(segment));
        m.beta[strand] = float(filter_beta(between, term.coherence));
    }
    // Particle k of the order comes with its V and sigma V, of (strand, particle), and stands still as yet.
    WETCURL_HD void take(uint32_t k, const float* volume, const float* wet_volume) const {
        const SortedPoint p = m.search.sorted[k];
        m.point[k] = {p.x, p.y, p.z, volume[p.id]};
        m.wet_volume[k] = wet_volume[p.id];
        m.displaced[p.id] = {0, 0, 0, k};
        const uint32_t cell = m.search.sorted_key[k];
        if (m.wet_cell && m.wet_volume[k] > 0 && cell < m.search.grid.cells()) m.wet_cell[cell] = 1;
    }
    // Calls visit(j), a rank, for each particle that Eq 10 sees from particle k of the order, once all are
    // taken. Returns whether one of them is wet: nobody is drawn to others.
    template <class Visit>
    WETCURL_HD bool neighbours(uint32_t k, Visit visit) const {
        const SortedPoint p = m.search.sorted[k];
        bool wet = !m.wet_cell;
        if (!wet && !m.search.any_cell(p.position(), [&](uint32_t cell) { return m.wet_cell[cell]; }))
            return false;
        m.search.neighbours(p.id, p.position(), [&](uint32_t j, const SortedPoint&) {
            visit(j);
            wet = wet || m.wet_volume[j] > 0;
        });
        return wet;
    }

    // p_i^w - p_i of particle k of the order, which is `id`.
    WETCURL_HD void displace(uint32_t k, uint32_t id, const Cohesion::Sums<float>& sums) const {
        const float volume = m.own_volume ? m.own_volume[id] : m.point[k].volume;
        const Vec3f d = term.displacement(sums, volume * m.own_weight[id / uint32_t(m.search.particles)]);
        m.displaced[id] = {d.x, d.y, d.z, k};
    }
    WETCURL_HD void move(uint32_t id, const Vec3f& by) const {
        HairPoint& p = m.point[m.displaced[id].rank];
        p = {p.x + by.x, p.y + by.y, p.z + by.z, p.volume};
    }
    // After the last pass, particle i of a strand; `simulated` (strand, particle) of all.
    WETCURL_HD ShownPoint shown(int strand, int i, const Vec3f* simulated) const {
        const Vec3f* x = simulated + size_t(strand) * size_t(thinning.particles);
        const Displaced* asked = m.displaced + size_t(strand) * size_t(m.search.particles);
        Vec3f p;
        if (thinning.every == 1) {
            p = m.point[asked[i].rank].position();
        } else {
            auto moved = [&](int j) { return m.point[asked[j].rank].position() - x[thinning.at(strand, j)]; };
            const Thinning::Place at = thinning.place(strand, i);
            p = x[i] + ((1 - at.after) * moved(at.before) + at.after * moved(at.before + 1));
        }
        return {p.x, p.y, p.z, i == 0 ? 0 : norm(x[i] - x[i - 1])};
    }
    // A strand x (particle), root to tip: no edge is longer than the term allows.
    WETCURL_HD void within_lengths(ShownPoint* x) const {
        for (int i = 1; i < thinning.particles; ++i) {
            const Vec3f p = term.within_length(x[i - 1].position(), x[i].position(), x[i].length);
            x[i].x = p.x, x[i].y = p.y, x[i].z = p.z;
        }
    }
};

// Pushed out of solids, as far as `allowed` for what is attached to the head.
template <class Solids>
WETCURL_HD Vec3f pushed_out(const Solids& solids, Vec3f x, float allowed) {
    for (const auto& solid : solids) {
        const auto d = distance_in_world(solid, cast<typename std::decay_t<decltype(solid)>::Number>(x));
        const float depth = (solid.attached ? allowed : 0.f) - float(d.phi);
        if (depth > 0) x += depth * cast<float>(d.normal);
    }
    return x;
}

}  // namespace wetcurl
