// Lists of neighbours as vectors read them: a cluster of consecutive sorted points, and runs of four sorted
// points, a bit for each pair of the one and the other that are neighbours.
// After the cluster pair lists of Pall and Hess 2013 (GROMACS), with runs of a uniform grid's rows.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "base/geometry/neighbor_grid.h"

namespace wetcurl {

class NeighborList {
  public:
    static constexpr size_t cluster = quads;  // points
    // What is read of each point by fours is longer by this than there are points.
    static constexpr size_t padding = 4;

    // Neighbours of each sorted point k of `grid`: the points within `radius` [m] (at most the grid's) of
    // another group than its own (PointQuads::set_group). Points without a neighbour of positive `source` get
    // none at all. `source`: (points and a vector more), in the grid's order.
    void build(const NeighborGrid& grid, const std::vector<float>& source, float radius);

    size_t clusters() const { return clusters_; }
    // Runs of cluster c, of points c * cluster and on: visit(four, bits), where bit 4 i + j says that sorted
    // point 4 four + j is a neighbour of the cluster's i-th: a lane each where each of them has a quad.
    template <class Visit>
    void visit_runs(size_t c, Visit visit) const {
        const uint32_t begin = *begin_of(c), end = begin_of(c)[1];
        if (far_.empty())
            for (uint32_t r = begin; r < end; ++r)
                visit(own_four(c) + size_t(long(offset_[r])), uint32_t(bits_[r]));
        else
            for (uint32_t r = begin; r < end; ++r) visit(size_t(far_[r]), uint32_t(bits_[r]));
    }
    // visit(j) for the neighbours of sorted point k, in the grid's order.
    template <class Visit>
    void visit_neighbours(size_t k, Visit visit) const {
        visit_runs(k / cluster, [&](size_t four, uint32_t bits) {
            for (bits = bits >> 4 * (k % cluster) & 15; bits; bits &= bits - 1)
                visit(4 * four + size_t(std::countr_zero(bits)));
        });
    }
    double neighbours_mean() const { return mean_; }
    size_t bytes() const;

  private:
    // What a thread has found of a chunk.
    struct Found {
        std::vector<uint32_t> four;
        std::vector<uint16_t> bits;
        size_t count = 0;
        void make_room(size_t more) {
            if (count + more <= four.size()) return;
            const size_t room = 2 * (count + more) + 2048;
            four.resize(room), bits.resize(room);
        }
    };
    // Of cluster c, the sweep's next.
    struct Search {
        const NeighborGrid& grid;
        const std::vector<float>& source;
        const std::vector<uint8_t>& some_source;
        float radius;
        uint32_t operator()(NeighborGrid::Sweep& sweep, size_t c, Found& found) const;
    };

    static constexpr size_t sources = 64;  // points of `some_source_`
    // Chunks of clusters lie wherever a thread found room; a chunk has one more begin than clusters.
    static constexpr size_t chunk = 128;
    const uint32_t* begin_of(size_t c) const { return &begin_[c + c / chunk]; }
    static size_t own_four(size_t c) { return c * cluster / 4; }
    size_t clusters_ = 0;
    std::vector<uint32_t> begin_;
    // (run) which four points: how many fours from the cluster's own. Once one was too far for 16 bits,
    // `far_` holds the fours themselves, of all runs, and `offset_` is empty.
    std::vector<int16_t> offset_;
    std::vector<uint32_t> far_;
    std::vector<uint16_t> bits_;
    // (64 points) whether one of them has a source: who has none around is not searched for.
    std::vector<uint8_t> some_source_;
    std::vector<Found> found_;  // (thread)
    double mean_ = 0;
};

}  // namespace wetcurl
