// Neighbour lists and sums of Eq 10 by tiles, that is particles that follow each other in the order of cells.
// What a tile may see is copied to its block's own memory, where threads gather from it several times as fast
// as from the caches. Ours.
#pragma once

#include "cuda/cohesion_bodies.h"
#include "cuda/team.h"

namespace wetcurl {

// A block's own memory while it makes lists.
struct TileSearch {
    static constexpr int slots = 2048, staged = 48;
    // A cell with particles that the tile may see, and where these are among all that it may.
    struct Cell {
        uint32_t key, begin;
        uint16_t first, count;
    };
    SortedPoint seen[most_seen];  // of who is dry the id has a bit more
    Cell cell[slots];             // by a hash of their keys
    uint16_t occupied[slots], head[tile_particles];
    uint16_t near[staged * tile_particles];  // the first that were found, by particle
    uint32_t found[tile_particles];
    uint8_t who[tile_particles];
    unsigned heads, cells, count, pairs, row;
};
// And while it sums.
struct TileSums {
    HairPoint point[most_seen + 1];
    float wet_volume[most_seen + 1];
};

template <class Meeting>
class CohesionTile {
    static constexpr uint32_t none = 0xffffffffu, dry = 0x80000000u;
    static constexpr int lanes = 32, lanes_a_cell = 8, slots = TileSearch::slots, staged = TileSearch::staged,
                         size = tile_particles;
    using Cell = TileSearch::Cell;

  public:
    WETCURL_HD CohesionTile(const CohesionBodies& b, const Team<Meeting>& team, uint32_t tile)
        : b_(b),
          m_(b.m),
          team_(team),
          tile_(tile),
          first_(tile * uint32_t(size)),
          count_(int(m_.search.count - first_ < uint32_t(size) ? m_.search.count - first_ : uint32_t(size))) {
    }

    // Lists, once all particles are taken. `reserve(rows, pairs)`, asked by one thread, returns the row of
    // the lists' memory from which so many are this tile's, no_list where there is no room.
    template <class Reserve>
    WETCURL_HD void list(TileSearch& own, Reserve reserve) const {
        look_around(own);
        const bool near = sees_few(own);
        auto neighbours = [&](int p, auto visit) {
            const uint32_t k = first_ + uint32_t(p);
            return near ? b_.neighbours(k, Around{own}, visit) : b_.neighbours(k, Everyone{m_}, visit);
        };
        team_.each(size, [&](int p) {
            uint32_t found = 0;
            const bool wet = p < count_ && neighbours(p, [&](uint32_t j) {
                                 if (near && found < staged) own.near[int(found) * size + p] = uint16_t(j);
                                 ++found;
                             });
            own.found[p] = wet ? found : 0;
            Meeting::add(own.pairs, own.found[p]);
        });
        team_.wait();
        // Those with the longest lists first, so that lists of the same lanes' are about as long.
        team_.each(size, [&](int p) {
            int place = 0;
            for (int q = 0; q < size; ++q)
                place += own.found[q] > own.found[p] || (own.found[q] == own.found[p] && q < p);
            own.who[place] = uint8_t(p);
        });
        team_.wait();
        const uint32_t seen_rows = near ? (own.count + list_row - 1) / list_row : 0, of_each = near ? 1 : 2;
        auto rows_of = [&](int group) { return (own.found[own.who[group * lanes]] + 3) / 4; };
        if (team_.thread == 0) {
            uint32_t rows = 0;
            for (int g = 0; g < size / lanes; ++g) rows += rows_of(g);
            own.row = rows == 0 ? no_list : reserve(seen_rows + of_each * rows, own.pairs);
            uint32_t row = own.row + seen_rows;
            for (int g = 0; g < size / lanes; ++g) {
                const uint32_t all = own.row == no_list ? 0 : rows_of(g);
                m_.group[tile_ * (size / lanes) + uint32_t(g)] = {row, all};
                row += of_each * all;
            }
            m_.tile[tile_] = {own.row, near ? own.count : too_many};
        }
        team_.wait();
        if (own.row == no_list) return;
        if (near)
            for_each_seen(own, [&](const Cell& cell, uint32_t i) {
                m_.list[list_row * size_t(own.row) + cell.first + i] = cell.begin + i;
            });
        team_.each(size, [&](int lane) {
            const int p = own.who[lane];
            m_.who[first_ + uint32_t(lane)] = own.who[lane];
            const ListGroup group = m_.group[(first_ + uint32_t(lane)) / lanes];
            const uint32_t found = own.found[p];
            if (near)
                fill<uint16_t>(group, lane, own.count, [&](auto put) {
                    if (found > staged) return void(neighbours(p, put));
                    for (uint32_t e = 0; e < found; ++e) put(own.near[int(e) * size + p]);
                });
            else
                fill<uint32_t>(group, lane, m_.search.count, [&](auto put) {
                    if (found > 0) neighbours(p, put);
                });
        });
    }

    // Half of a Jacobi pass: p_i^w - p_i of each. Roots stay.
    WETCURL_HD void displace(TileSums& own) const {
        const Tile tile = m_.tile[tile_];
        if (tile.row == no_list) return;
        if (tile.seen == too_many) {
            for_each_lane([&](uint32_t k, const ListGroup& group, int lane) {
                sum<uint32_t>(k, group, lane, m_.search.count,
                              [&](uint32_t j, auto add) { add(m_.point[j], m_.wet_volume[j]); });
            });
            return;
        }
        team_.each(int(tile.seen) + 1, [&](int i) {
            const uint32_t rank =
                i < int(tile.seen) ? m_.list[list_row * size_t(tile.row) + uint32_t(i)] : m_.search.count;
            own.point[i] = m_.point[rank], own.wet_volume[i] = m_.wet_volume[rank];
        });
        team_.wait();
        for_each_lane([&](uint32_t k, const ListGroup& group, int lane) {
            sum<uint16_t>(k, group, lane, tile.seen,
                          [&](uint32_t j, auto add) { add(own.point[j], own.wet_volume[j]); });
        });
    }

  private:
    // Where neighbours are looked for.
    struct Everyone {
        const CohesionMemory& m;
        WETCURL_HD CellRange range(uint32_t key) const { return m.search.range(key); }
        WETCURL_HD SortedPoint point(uint32_t k) const { return m.search.point(k); }
        WETCURL_HD bool wet(uint32_t k) const { return m.wet_volume[k] > 0; }
    };
    struct Around {
        const TileSearch& own;
        WETCURL_HD CellRange range(uint32_t key) const {
            for (uint32_t s = slot_of(key);; s = (s + 1) % slots) {
                const Cell& cell = own.cell[s];
                if (cell.key == key) return {cell.first, uint32_t(cell.first) + cell.count};
                if (cell.key == none) return {no_particle, no_particle};
            }
        }
        WETCURL_HD SortedPoint point(uint32_t k) const {
            SortedPoint p = own.seen[k];
            p.id &= ~dry;
            return p;
        }
        WETCURL_HD bool wet(uint32_t k) const { return !(own.seen[k].id & dry); }
    };
    // Half of the slots stay free, so that what is not there is soon known not to be.
    WETCURL_HD static bool sees_few(const TileSearch& own) {
        return own.count <= unsigned(most_seen) && own.cells <= unsigned(slots / 2);
    }
    WETCURL_HD static uint32_t slot_of(uint32_t key) { return key * 2654435761u >> 21; }

    // Copies what lies in the cells of the tile's particles and in those around them, if that is not too
    // much.
    WETCURL_HD void look_around(TileSearch& own) const {
        const CellSearch& search = m_.search;
        team_.each(slots, [&](int s) { own.cell[s].key = none; });
        if (team_.thread == 0) own.heads = own.cells = own.count = own.pairs = 0;
        team_.wait();
        team_.each(count_, [&](int p) {
            const uint32_t k = first_ + uint32_t(p), key = search.sorted_key[k];
            if (key != search.grid.cells() && (p == 0 || search.sorted_key[k - 1] != key))
                own.head[Meeting::add(own.heads, 1)] = uint16_t(p);
        });
        team_.wait();
        team_.share(int(own.heads), 27, [&](int head, int around) {
            const auto c =
                search.grid.cell_of(search.sorted[first_ + own.head[head]].position() - search.origin);
            take_cell(own,
                      search.grid.key(c.x + around % 3 - 1, c.y + around / 3 % 3 - 1, c.z + around / 9 - 1));
        });
        if (!sees_few(own)) return;
        for_each_seen(own, [&](const Cell& cell, uint32_t i) {
            SortedPoint p = search.sorted[cell.begin + i];
            if (m_.wet_cell && !(m_.wet_volume[cell.begin + i] > 0)) p.id |= dry;
            own.seen[cell.first + i] = p;
        });
        team_.wait();
    }
    WETCURL_HD void take_cell(TileSearch& own, uint32_t key) const {
        const CellRange range = m_.search.range(key);
        if (range.begin == no_particle) return;
        for (uint32_t tried = 0, s = slot_of(key); tried < slots; ++tried, s = (s + 1) % slots) {
            const unsigned before = Meeting::claim(own.cell[s].key, none, key);
            if (before == key) return;
            if (before != none) continue;
            const uint32_t count = range.end - range.begin, at = Meeting::add(own.count, count);
            own.cell[s].begin = range.begin, own.cell[s].first = uint16_t(at),
            own.cell[s].count = uint16_t(count);
            own.occupied[Meeting::add(own.cells, 1)] = uint16_t(s);
            return;
        }
    }
    // f(cell, i): the i-th of a cell.
    template <class F>
    WETCURL_HD void for_each_seen(const TileSearch& own, F f) const {
        team_.share(int(own.cells), lanes_a_cell, [&](int k, int lane) {
            const Cell& cell = own.cell[own.occupied[k]];
            for (uint32_t i = uint32_t(lane); i < cell.count; i += lanes_a_cell) f(cell, i);
        });
    }

    // Of a list.
    template <class Entry>
    struct alignas(4 * sizeof(Entry)) Four {
        Entry of[4];
        WETCURL_HD void append(Entry j) { of[0] = of[1], of[1] = of[2], of[2] = of[3], of[3] = j; }
    };
    template <class Entry>
    WETCURL_HD Four<Entry>* entries(const ListGroup& group, int lane) const {
        return reinterpret_cast<Four<Entry>*>(m_.list + list_row * size_t(group.row)) + lane % lanes;
    }
    // A lane's list, filled up with nobody. `visit(put)` puts what was found.
    template <class Entry, class Visit>
    WETCURL_HD void fill(const ListGroup& group, int lane, uint32_t nobody, Visit visit) const {
        Four<Entry>* list = entries<Entry>(group, lane);
        Four<Entry> last{};
        uint32_t e = 0;
        auto put = [&](uint32_t j) {
            last.append(Entry(j));
            if (++e % 4 == 0) list[lanes * size_t(e / 4 - 1)] = last;
        };
        visit(put);
        while (e < 4 * group.rows) put(nobody);
    }
    // f(k, group, lane) of those who have a list.
    template <class F>
    WETCURL_HD void for_each_lane(F f) const {
        team_.each(size, [&](int lane) {
            const ListGroup group = m_.group[(first_ + uint32_t(lane)) / lanes];
            if (group.rows > 0) f(first_ + m_.who[first_ + uint32_t(lane)], group, lane);
        });
    }
    // `other(j, add)` adds entry j. Who sees nobody stays where it is, be that anywhere.
    template <class Entry, class Other>
    WETCURL_HD void sum(uint32_t k, const ListGroup& group, int lane, uint32_t nobody, Other other) const {
        const Four<Entry>* list = entries<Entry>(group, lane);
        Four<Entry> next = list[0];
        if (k >= m_.search.count || next.of[0] == Entry(nobody)) return;
        const uint32_t id = m_.search.sorted_id[k];
        if (id % uint32_t(m_.search.particles) == 0) return;
        const Vec3f own = m_.point[k].position();
        Cohesion::Sums<float> sums{{0, 0, 0}, 0};
        for (uint32_t row = 1; row <= group.rows; ++row) {
            const Four<Entry> now = next;
            if (row < group.rows) next = list[lanes * size_t(row)];
            for (int l = 0; l < 4; ++l)
                other(now.of[l], [&](const HairPoint& p, float wet_volume) {
                    sums.add(p.position() - own, m_.search.radius, p.volume, wet_volume);
                });
        }
        b_.displace(k, id, sums);
    }

    const CohesionBodies& b_;
    const CohesionMemory& m_;
    const Team<Meeting>& team_;
    const uint32_t tile_, first_;
    const int count_;
};

}  // namespace wetcurl
