// Neighbour lists of Eq 10 for particles that follow each other in the order of cells, by a block's threads
// together.
#pragma once

#include "cuda/cohesion/cohesion_kernel_body.h"
#include "cuda/device/thread_team.h"

namespace wetcurl {

// A block's own memory meanwhile.
struct ListRoom {
    static constexpr int size = list_block, lengths = 64, groups = size / ListGroup::lanes;
    // Numbers beside it, (entry, particle): the first `staged` that are found, then what finds no room.
    static constexpr size_t near(int staged) { return size_t(staged + 1) * size_t(size); }
    uint32_t found[size];
    uint8_t who[size];
    // How many lists are about as long, and which lane the next of them gets.
    unsigned of_length[lengths], place[lengths];
    unsigned rows[groups], pairs, row;  // of each group; of all; the first
};

template <class Barrier>
class CohesionLists {
    static constexpr int size = ListRoom::size, lengths = ListRoom::lengths, groups = ListRoom::groups,
                         lanes = ListGroup::lanes;

  public:
    // `near`: as the room says, of so many.
    WETCURL_HD CohesionLists(const CohesionKernelBody& b, const ThreadTeam<Barrier>& team, uint32_t block,
                             uint32_t* near, int staged)
        : b_(b), team_(team), block_(block), first_(block * uint32_t(size)), near_(near), staged_(staged) {}

    // Where some hair is dry, once all particles are taken. `reserve(rows, pairs)`, asked by one thread,
    // returns the row from which so many are this block's, no_list where there is no room.
    template <class Reserve>
    WETCURL_HD void build(ListRoom& own, Reserve reserve) const {
        team_.each(lengths, [&](int l) { own.of_length[l] = 0; });
        team_.each(groups, [&](int g) { own.rows[g] = 0; });
        if (team_.thread == 0) own.pairs = 0;
        team_.wait();
        team_.each(size, [&](int p) { find(own, p); });
        team_.wait();
        order(own);
        if (team_.thread == 0) share_rows(own, reserve);
        team_.wait();
        if (own.row != no_list) team_.each(size, [&](int lane) { fill(own, lane); });
    }

  private:
    WETCURL_HD void find(ListRoom& own, int p) const {
        const uint32_t k = first_ + uint32_t(p);
        const int last = staged_ * size + p;
        int at = p;
        uint32_t found = 0;
        const bool wet = k < b_.m.search.count && b_.neighbours(k, [&](bool near, uint32_t j) {
            near_[at] = j;
            at += near ? size : 0;
            at = at < last ? at : last;
            found += near;
        });
        own.found[p] = found = wet ? found : 0;
        Barrier::add(own.of_length[length_of(found)], 1);
        Barrier::add(own.pairs, found);
    }
    WETCURL_HD static uint32_t rows_of(uint32_t found) { return (found + 3) / 4; }
    WETCURL_HD static int length_of(uint32_t found) {
        const int rows = int(rows_of(found));
        return lengths - 1 - (rows < lengths ? rows : lengths - 1);
    }
    // Lanes take the particles with the longest lists first, so that those of a group are about as long.
    WETCURL_HD void order(ListRoom& own) const {
        team_.each(lengths, [&](int l) {
            unsigned longer = 0;
            for (int k = 0; k < l; ++k) longer += own.of_length[k];
            own.place[l] = longer;
        });
        team_.wait();
        team_.each(size, [&](int p) {
            const unsigned lane = Barrier::add(own.place[length_of(own.found[p])], 1);
            own.who[lane] = uint8_t(p);
            Barrier::at_least(own.rows[lane / lanes], rows_of(own.found[p]));
        });
        team_.wait();
    }
    template <class Reserve>
    WETCURL_HD void share_rows(ListRoom& own, Reserve reserve) const {
        uint32_t all = 0;
        for (int g = 0; g < groups; ++g) all += own.rows[g];
        own.row = all > 0 ? reserve(all, own.pairs) : no_list;
        for (uint32_t g = 0, row = own.row; g < groups; row += own.rows[g++])
            b_.m.group[block_ * groups + g] = {row, own.row == no_list ? 0 : own.rows[g]};
    }
    // A lane's list, filled up with nobody.
    WETCURL_HD void fill(const ListRoom& own, int lane) const {
        const uint32_t place = first_ + uint32_t(lane);
        const int p = own.who[lane];
        b_.m.who[place] = own.who[lane];
        const ListGroup group = b_.m.group[place / lanes];
        Ranks<4>* list = b_.m.entries(group, place);
        Ranks<4> four{};
        uint32_t e = 0;
        auto put = [&](uint32_t j) {
            four.of[0] = four.of[1], four.of[1] = four.of[2], four.of[2] = four.of[3], four.of[3] = j;
            if (++e % 4 == 0) list[lanes * size_t(e / 4 - 1)] = four;
        };
        if (own.found[p] > uint32_t(staged_))
            b_.neighbours(first_ + uint32_t(p), [&](bool near, uint32_t j) {
                if (near && e < own.found[p]) put(j);
            });
        else
            for (uint32_t n = 0; n < own.found[p]; ++n) put(near_[int(n) * size + p]);
        while (e < 4 * group.rows) put(b_.m.search.count);
    }

    const CohesionKernelBody& b_;
    const ThreadTeam<Barrier>& team_;
    const uint32_t block_, first_;
    uint32_t* const near_;
    const int staged_;
};

}  // namespace wetcurl
