// Neighbour lists and sums of Eq 10 by tiles, that is particles that follow each other in the order of cells.
// What a tile may see is copied to its block's own memory while it sums, and lists count among that: two
// bytes an entry, gathered from near. Ours.
#pragma once

#include "cuda/cohesion_bodies.h"
#include "cuda/team.h"

namespace wetcurl {

// A block's own memory while it makes lists.
struct TileSearch {
    static constexpr int slots = 2048, staged = 40, lengths = 64, groups = tile_particles / 32;
    // A cell with particles that the tile may see, and where these are among all that it may.
    struct Cell {
        uint32_t key, begin;
        uint16_t first, count;
    };
    Cell cell[slots];  // by a hash of their keys
    uint16_t occupied[slots], head[tile_particles];
    uint32_t near[staged * tile_particles];  // ranks of the first that were found, by particle
    uint32_t found[tile_particles];
    uint8_t who[tile_particles];
    // How many lists are about as long, and which lane the next of them gets.
    unsigned of_length[lengths], place[lengths];
    unsigned rows[groups], longest;
    unsigned heads, cells, seen, pairs, row;
};
// And while it sums.
struct TileSums {
    HairPoint point[most_seen + 1];
    float wet_volume[most_seen + 1];
};
// Three blocks at a time, of 228 KiB, of which each has one for itself.
static_assert(3 * (sizeof(TileSearch) + 1024) <= 228 * 1024 && 3 * (sizeof(TileSums) + 1024) <= 228 * 1024);
static_assert(most_seen < 0xffff && tile_particles <= 256);  // two bytes an entry, one a lane

template <class Meeting>
class CohesionTile {
    static constexpr uint32_t none = 0xffffffffu;
    static constexpr int lanes = 32, lanes_a_cell = 8, slots = TileSearch::slots, staged = TileSearch::staged,
                         lengths = TileSearch::lengths, groups = TileSearch::groups, size = tile_particles;
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
        team_.each(count_, [&](int p) {
            uint32_t found = 0;
            const bool wet = b_.neighbours(first_ + uint32_t(p), [&](uint32_t j) {
                if (found < staged) own.near[int(found) * size + p] = j;
                ++found;
            });
            own.found[p] = wet ? found : 0;
            Meeting::add(own.pairs, own.found[p]);
        });
        team_.wait();
        order(own);
        const bool few = sees_few(own);
        if (team_.thread == 0) share_rows(own, few, reserve);
        team_.wait();
        if (own.row == no_list) return;
        if (few)
            for_each_cell(own, [&](const Cell& cell, uint32_t i) {
                m_.list[list_row * size_t(own.row) + cell.first + i] = cell.begin + i;
            });
        team_.each(size, [&](int lane) {
            const int p = own.who[lane];
            m_.who[first_ + uint32_t(lane)] = own.who[lane];
            auto visit = [&](auto put) {
                if (own.found[p] > staged) return void(b_.neighbours(first_ + uint32_t(p), put));
                for (uint32_t e = 0; e < own.found[p]; ++e) put(own.near[int(e) * size + p]);
            };
            if (few)
                fill<uint16_t>(lane, own.seen,
                               [&](auto put) { visit([&](uint32_t j) { put(among_seen(own, j)); }); });
            else
                fill<uint32_t>(lane, m_.search.count, visit);
        });
    }

    // Half of a Jacobi pass: p_i^w - p_i of each. Roots stay.
    WETCURL_HD void displace(TileSums& own) const {
        const Tile tile = m_.tile[tile_];
        if (tile.row == no_list) return;
        if (tile.seen == too_many)
            return for_each_lane([&](int lane, uint32_t k) {
                sum<uint32_t>(lane, k, m_.search.count,
                              [&](uint32_t j, auto add) { add(m_.point[j], m_.wet_volume[j]); });
            });
        see(tile, own);
        team_.wait();
        for_each_lane([&](int lane, uint32_t k) {
            sum<uint16_t>(lane, k, tile.seen,
                          [&](uint32_t j, auto add) { add(own.point[j], own.wet_volume[j]); });
        });
    }

  private:
    // --- what may be seen

    // In the cells of the tile's particles and those around them.
    WETCURL_HD void look_around(TileSearch& own) const {
        const CellSearch& search = m_.search;
        team_.each(slots, [&](int s) { own.cell[s].key = none; });
        team_.each(size, [&](int p) { own.found[p] = 0; });
        team_.each(lengths, [&](int l) { own.of_length[l] = 0; });
        team_.each(groups, [&](int g) { own.rows[g] = 0; });
        if (team_.thread == 0) own.heads = own.cells = own.seen = own.pairs = own.longest = 0;
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
    }
    WETCURL_HD void take_cell(TileSearch& own, uint32_t key) const {
        const CellRange range = m_.search.cell[key];
        if (range.begin == no_particle) return;
        for (uint32_t tried = 0, s = slot_of(key); tried < slots; ++tried, s = (s + 1) % slots) {
            const unsigned before = Meeting::claim(own.cell[s].key, none, key);
            if (before == key) return;
            if (before != none) continue;
            const uint32_t count = range.end - range.begin, at = Meeting::add(own.seen, count);
            own.cell[s].begin = range.begin, own.cell[s].first = uint16_t(at);
            own.cell[s].count = uint16_t(count);
            own.occupied[Meeting::add(own.cells, 1)] = uint16_t(s);
            return;
        }
    }
    WETCURL_HD static uint32_t slot_of(uint32_t key) {
        static_assert(slots == 1 << (32 - 21));
        return key * 2654435761u >> 21;
    }
    // Whether a block's memory holds them, and half of the slots are free, so that cells are found soon.
    WETCURL_HD static bool sees_few(const TileSearch& own) {
        return own.seen <= unsigned(most_seen) && own.cells <= unsigned(slots / 2);
    }
    // f(cell, i): the i-th of a cell.
    template <class F>
    WETCURL_HD void for_each_cell(const TileSearch& own, F f) const {
        team_.share(int(own.cells), lanes_a_cell, [&](int k, int lane) {
            const Cell& cell = own.cell[own.occupied[k]];
            for (uint32_t i = uint32_t(lane); i < cell.count; i += lanes_a_cell) f(cell, i);
        });
    }
    WETCURL_HD uint32_t among_seen(const TileSearch& own, uint32_t rank) const {
        const uint32_t key = m_.search.sorted_key[rank];
        uint32_t s = slot_of(key);
        while (own.cell[s].key != key) s = (s + 1) % slots;
        return own.cell[s].first + (rank - own.cell[s].begin);
    }
    // Copies them; the last is nobody.
    WETCURL_HD void see(const Tile& tile, TileSums& own) const {
        constexpr int at_once = 5;  // on their way together: most tiles see so many times its threads
        const uint32_t* ranks = m_.list + list_row * size_t(tile.row);
        const int seen = int(tile.seen), threads = team_.threads;
        for (int first = team_.thread; first <= seen; first += at_once * threads) {
            uint32_t rank[at_once];
            HairPoint point[at_once];
            float wet_volume[at_once];
            for (int k = 0; k < at_once; ++k)
                rank[k] = first + k * threads < seen ? ranks[first + k * threads] : m_.search.count;
            for (int k = 0; k < at_once; ++k)
                point[k] = m_.point[rank[k]], wet_volume[k] = m_.wet_volume[rank[k]];
            for (int k = 0; k < at_once; ++k)
                if (first + k * threads <= seen)
                    own.point[first + k * threads] = point[k],
                                          own.wet_volume[first + k * threads] = wet_volume[k];
        }
    }

    // --- lists

    WETCURL_HD static uint32_t rows_of(uint32_t found) { return (found + 3) / 4; }
    // Lanes take the particles with the longest lists first, so that lists of the same group are about as
    // long.
    WETCURL_HD void order(TileSearch& own) const {
        team_.each(size, [&](int p) { Meeting::at_least(own.longest, rows_of(own.found[p])); });
        team_.wait();
        auto length_of = [&](int p) {
            const unsigned parts = lengths - 1;
            return int(parts - (own.longest > 0 ? rows_of(own.found[p]) * parts / own.longest : 0));
        };
        team_.each(size, [&](int p) { Meeting::add(own.of_length[length_of(p)], 1); });
        team_.wait();
        team_.each(lengths, [&](int l) {
            unsigned longer = 0;
            for (int k = 0; k < l; ++k) longer += own.of_length[k];
            own.place[l] = longer;
        });
        team_.wait();
        team_.each(size, [&](int p) {
            const unsigned lane = Meeting::add(own.place[length_of(p)], 1);
            own.who[lane] = uint8_t(p);
            Meeting::at_least(own.rows[lane / lanes], rows_of(own.found[p]));
        });
        team_.wait();
    }
    template <class Reserve>
    WETCURL_HD void share_rows(TileSearch& own, bool few, Reserve reserve) const {
        const uint32_t seen = few ? (own.seen + list_row - 1) / list_row : 0, of_each = few ? 1 : 2;
        uint32_t all = 0;
        for (int g = 0; g < groups; ++g) all += of_each * own.rows[g];
        own.row = all == 0 ? no_list : reserve(seen + all, own.pairs);
        m_.tile[tile_] = {own.row, few ? own.seen : too_many};
        for (uint32_t g = 0, row = own.row + seen; g < groups; ++g) {
            m_.group[tile_ * groups + g] = {row, own.row == no_list ? 0 : own.rows[g]};
            row += of_each * own.rows[g];
        }
    }
    template <class Entry>
    struct alignas(4 * sizeof(Entry)) Four {
        Entry of[4];
        WETCURL_HD void append(Entry j) { of[0] = of[1], of[1] = of[2], of[2] = of[3], of[3] = j; }
    };
    WETCURL_HD ListGroup group_of(int lane) const { return m_.group[(first_ + uint32_t(lane)) / lanes]; }
    template <class Entry>
    WETCURL_HD Four<Entry>* entries(const ListGroup& group, int lane) const {
        return reinterpret_cast<Four<Entry>*>(m_.list + list_row * size_t(group.row)) + lane % lanes;
    }
    // A lane's list, filled up with nobody. `visit(put)` puts what was found.
    template <class Entry, class Visit>
    WETCURL_HD void fill(int lane, uint32_t nobody, Visit visit) const {
        const ListGroup group = group_of(lane);
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

    // --- sums

    // f(lane, k) of those who may have a list.
    template <class F>
    WETCURL_HD void for_each_lane(F f) const {
        team_.each(size, [&](int lane) {
            const uint32_t k = first_ + m_.who[first_ + uint32_t(lane)];
            if (k < m_.search.count) f(lane, k);
        });
    }
    // `other(j, add)` adds entry j. Who sees nobody stays where it is, be that anywhere.
    template <class Entry, class Other>
    WETCURL_HD void sum(int lane, uint32_t k, uint32_t nobody, Other other) const {
        const ListGroup group = group_of(lane);
        const uint32_t id = m_.search.sorted_id[k];
        if (group.rows == 0 || id % uint32_t(m_.search.particles) == 0) return;
        const Four<Entry>* list = entries<Entry>(group, lane);
        Four<Entry> next = list[0];
        if (next.of[0] == Entry(nobody)) return;
        const Vec3f here = m_.point[k].position();
        Cohesion::Sums<float> sums{{0, 0, 0}, 0};
        for (uint32_t row = 1; row <= group.rows; ++row) {
            const Four<Entry> now = next;
            if (row < group.rows) next = list[lanes * size_t(row)];
            for (int l = 0; l < 4; ++l)
                other(now.of[l], [&](const HairPoint& p, float wet_volume) {
                    sums.add(p.position() - here, m_.search.radius, p.volume, wet_volume);
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
