// Lists of neighbours as vectors read them: runs of consecutive sorted points, a bit for each neighbour.
// After the cluster pair lists of Pall and Hess 2013 (GROMACS), with runs of a uniform grid's rows.
#pragma once

#include <cstdint>
#include <vector>

#include "base/geometry/neighbor_grid.h"

namespace wetcurl {

class NeighborList {
  public:
    static constexpr uint32_t lanes = lanes_of<float>;

    // Neighbours of each sorted point k of `grid`: the points within `radius` [m] (at most the grid's) of
    // another group than its own. Points without a neighbour of positive `source` get none at all.
    // `group`, `source`: (points and a vector more), in the grid's order.
    void build(const NeighborGrid& grid, const std::vector<uint32_t>& group, const std::vector<float>& source,
               float radius);

    // Runs of point k: visit(first, bits), where bit l says that sorted point first + l is a neighbour.
    template <class Visit>
    void visit_runs(size_t k, Visit visit) const {
        const uint32_t* begin = &begin_[k + k / chunk];
        for (uint32_t r = begin[0]; r < begin[1]; ++r) visit(first_[r], uint32_t(bits_[r]));
    }
    bool empty(size_t k) const { return begin_[k + k / chunk] == begin_[k + k / chunk + 1]; }
    double neighbours_mean() const { return mean_; }
    size_t bytes() const;

  private:
    // What a thread has found of a chunk.
    struct Found {
        std::vector<uint32_t> first;
        std::vector<uint16_t> bits;
        size_t count = 0;
        void make_room(size_t more) {
            if (count + more <= first.size()) return;
            first.resize(2 * (count + more)), bits.resize(2 * (count + more));
        }
    };
    static uint32_t search(const NeighborGrid& grid, NeighborGrid::Sweep& sweep,
                           const std::vector<uint32_t>& group, const std::vector<float>& source, float radius,
                           size_t k, Found& found);

    // Chunks of points lie wherever a thread found room; a chunk has one more begin than points.
    static constexpr size_t chunk = 512;
    std::vector<uint32_t> first_, begin_;
    std::vector<uint16_t> bits_;
    std::vector<Found> found_;  // (thread)
    double mean_ = 0;
};

}  // namespace wetcurl
