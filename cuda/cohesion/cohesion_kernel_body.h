// Eq 10 on a device, particle by particle: neighbours, displacements, and where a particle is shown. The
// formulas are those of solver/terms/cohesion.h; the reference is solver/cohesion/cohesion_pass.h.
#pragma once

#include <cstdint>
#include <cstring>
#include <type_traits>

#include "base/geometry/filter.h"
#include "cuda/device/cell_search.h"
#include "cuda/device/thread_team.h"
#include "solver/cohesion/thinning.h"
#include "solver/solids/contact.h"
#include "solver/terms/cohesion.h"

namespace wetcurl {

// Entries of a list, ranks in the order of cells.
template <int count>
struct alignas(4 * count) Ranks {
    uint32_t of[count];
};
// What is read once in a pass shall not drive what is read again from the caches.
template <int count>
WETCURL_HD Ranks<count> read_once(const uint32_t* from) {
    Ranks<count> ranks;
#ifdef __CUDA_ARCH__
    using Whole = std::conditional_t<count == 4, uint4, unsigned>;
    static_assert(sizeof ranks == sizeof(Whole));
    const Whole whole = __ldcs(reinterpret_cast<const Whole*>(from));
    memcpy(&ranks, &whole, sizeof ranks);
#else
    std::memcpy(&ranks, from, sizeof ranks);
#endif
    return ranks;
}

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
    WETCURL_HD void put(const Vec3f& p) { x = p.x, y = p.y, z = p.z; }
};
// Lists are made for so many at a time that follow each other in the order of cells.
constexpr int list_block = 128;
// Neighbour lists of 32 of a block: four entries a lane from `row` on, `rows` times.
struct ListGroup {
    static constexpr int lanes = 32;
    uint32_t row, rows;
};
inline constexpr uint32_t no_list = 0xffffffffu;  // in a row's place

// Particles are taken in the order of cells, those who share their neighbours side by side, so that these
// come from the caches. Where not all particles of a strand are asked, those who are count from its root as
// all of them would.
struct CohesionMemory {
    CellSearch search;  // within Eq 10's h
    // In the order of cells, and one more who is nobody, without volume.
    HairPoint* point;
    float* wet_volume;  // sigma V
    // (cells) whether a wet particle that is seen lies there; null where all are wet, and seen.
    uint8_t* wet_cell;
    ListGroup* group;      // (blocks, groups of 32)
    uint8_t* who;          // (blocks, 128) of its block's particles a lane takes; any where there is no list
    Ranks<4>* list;        // (row, lane); lists are filled up with nobody, of rank search.count
    Displaced* displaced;  // (strand, particle)
    float *beta, *own_weight;  // (strand) of the smoothing; Eq 10's own_weight
    const float* own_volume;   // (strand, particle) of itself, null: V is
    float* self_weight;        // in the order of cells: own volume times own_weight, as Eq 10 takes it

    // Of the lane at `place` (blocks, 128).
    WETCURL_HD Ranks<4>* entries(const ListGroup& g, uint32_t place) const {
        return list + ListGroup::lanes * size_t(g.row) + place % ListGroup::lanes;
    }
};

struct CohesionKernelBody {
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
    // Particle k of the order, once its strand is measured, comes with its V and sigma V, of (strand,
    // particle), and stands still as yet.
    WETCURL_HD void take(uint32_t k, const float* volume, const float* wet_volume) const {
        const SortedPoint p = m.search.sorted[k];
        m.point[k] = {p.x, p.y, p.z, volume[p.id]};
        m.wet_volume[k] = wet_volume[p.id];
        m.self_weight[k] =
            (m.own_volume ? m.own_volume : volume)[p.id] * m.own_weight[p.id / uint32_t(m.search.particles)];
        m.displaced[p.id] = {0, 0, 0, k};
        if (!m.wet_cell || !(m.wet_volume[k] > 0)) return;
        const uint32_t cell = m.search.cell_of(p.position());
        if (cell < m.search.grid.cells()) m.wet_cell[cell] = 1;
    }
    // Calls candidate(near, j) for particles around particle k of the order, where some hair is dry or not
    // seen once all are taken: `near` for those that Eq 10 sees, j their rank. Returns false where all of
    // them are dry: nobody is drawn to those.
    template <class Candidate>
    WETCURL_HD bool neighbours(uint32_t k, Candidate candidate) const {
        const SortedPoint p = m.search.sorted[k];
        auto candidates = [&](auto each) {
            m.search.candidates(p.id, p.position(),
                                [&](bool near, uint32_t j, const SortedPoint&) { each(near, j); });
        };
        if (!m.wet_cell) return candidates(candidate), true;
        bool wet = false;
        if (m.search.any_cell(p.position(), [&](uint32_t cell) { return m.wet_cell[cell]; }))
            candidates([&](bool near, uint32_t j) {
                const bool seen = near && m.point[j].volume > 0;
                candidate(seen, j);
                if (seen) wet = wet || m.wet_volume[j] > 0;
            });
        return wet;
    }

    // p_i^w - p_i of whom the lane at `place` (blocks, 128) takes, by `shared` threads, this one its `part`,
    // of which each sums up some entries of the list; together(x) adds x up over them. Roots stay, and who
    // has no neighbour.
    template <int shared = 1, class Together>
    WETCURL_HD void displace(uint32_t place, int part, Together together) const {
        constexpr int each = 4 / shared;
        const uint32_t k = place - place % uint32_t(list_block) + m.who[place], nobody = m.search.count;
        const ListGroup group = m.group[place / ListGroup::lanes];
        if (k >= nobody || group.rows == 0) return;
        const Ranks<4>* list = m.entries(group, place);
        const uint32_t id = m.search.sorted_id[k], n = uint32_t(m.search.particles);
        if (id % n == 0 || list[0].of[0] == nobody) return;
        auto entries = [&](uint32_t row) {
            return read_once<each>(list[ListGroup::lanes * size_t(row)].of + each * part);
        };
        const HairPoint own = m.point[k];
        Cohesion::Sums<float> sums{{0, 0, 0}, 0};
        Ranks<each> next = entries(0);
        for (uint32_t row = 1; row <= group.rows; ++row) {
            const Ranks<each> now = next;
            if (row < group.rows) next = entries(row);
            for (const uint32_t j : now.of) {
                const HairPoint other = m.point[j];
                sums.add(other.position() - own.position(), m.search.radius, other.volume, m.wet_volume[j]);
            }
        }
        sums = {{together(sums.pull.x), together(sums.pull.y), together(sums.pull.z)}, together(sums.weight)};
        const Vec3f d = term.displacement(sums, m.self_weight[k]);
        if (part == 0) m.displaced[id] = {d.x, d.y, d.z, k};
    }
    // A block's own memory while it moves strands: displacements (3, strand, particle), of so many numbers a
    // strand that those of particle i lie in different banks; (strand, particle) where particles are and
    // their ranks, which are read anew where these are null.
    struct MoveWorkspace {
        float* by;
        HairPoint* from;
        uint32_t* rank;
        WETCURL_HD static int numbers_a_strand(int particles) { return particles | 1; }
    };
    // By the pass at hand, smoothed along each: `strands` from `first` on, a thread for a coordinate of one.
    template <class Barrier>
    WETCURL_HD void move_strands(const ThreadTeam<Barrier>& team, int first, int strands,
                                 const MoveWorkspace& own) const {
        const int n = m.search.particles, row = MoveWorkspace::numbers_a_strand(n), axis_at = strands * row;
        const Displaced* displaced = m.displaced + size_t(first) * size_t(n);
        team.share(strands, n, [&](int s, int i) {
            const int k = s * n + i;
            const Displaced d = displaced[k];
            float* by = own.by + s * row + i;
            by[0] = d.x, by[axis_at] = d.y, by[2 * axis_at] = d.z;
            if (own.from) own.rank[k] = d.rank, own.from[k] = m.point[d.rank];
        });
        if (term.coherence > 0)
            team.share(3, strands, [&](int axis, int s) {
                float* line = own.by + axis * axis_at + s * row;
                smooth_along<8>(n, m.beta[first + s], [&](int i) -> float& { return line[i]; });
            });
        team.share(strands, n, [&](int s, int i) {
            const int k = s * n + i;
            const float* by = own.by + s * row + i;
            const uint32_t rank = own.from ? own.rank[k] : displaced[k].rank;
            const HairPoint from = own.from ? own.from[k] : m.point[rank];
            m.point[rank] = {from.x + by[0], from.y + by[axis_at], from.z + by[2 * axis_at], from.volume};
        });
    }
    // How far the passes have moved the j-th particle of a strand that is asked; `simulated` (strand,
    // particle) of all.
    WETCURL_HD Vec3f moved(int strand, int j, const Vec3f* simulated) const {
        const uint32_t rank = m.displaced[size_t(strand) * size_t(m.search.particles) + size_t(j)].rank;
        return m.point[rank].position() -
               simulated[size_t(strand) * size_t(thinning.particles) + size_t(thinning.at(strand, j))];
    }
    // After the last pass, particle i of a strand; where not all are asked, `by` (particle that is): how far
    // its strand's have moved.
    WETCURL_HD ShownPoint shown(int strand, int i, const Vec3f* simulated, const Vec3f* by) const {
        const Vec3f* x = simulated + size_t(strand) * size_t(thinning.particles);
        Vec3f p;
        if (thinning.every == 1) {
            p = m.point[m.displaced[size_t(strand) * size_t(m.search.particles) + size_t(i)].rank].position();
        } else {
            const Thinning::Place at = thinning.place(strand, i);
            p = x[i] + ((1 - at.after) * by[at.before] + at.after * by[at.before + 1]);
        }
        return {p.x, p.y, p.z, i == 0 ? 0 : norm(x[i] - x[i - 1])};
    }
    // A strand x (particle), root to tip: no edge is longer than the term allows.
    WETCURL_HD void within_lengths(ShownPoint* x) const {
        Vec3f before = x[0].position();
        ShownPoint next = x[1];  // read before the one before it is written
        for (int i = 1; i < thinning.particles; ++i) {
            const ShownPoint now = next;
            if (i + 1 < thinning.particles) next = x[i + 1];
            x[i].put(before = term.within_length(before, now.position(), now.length));
        }
    }
};

}  // namespace wetcurl
