// The cohesion pass: Eq 10 over neighbour lists that are built once a frame, iterated by Jacobi.
// Gathers only; each particle writes its own slot, so the result is the same for any number of threads.
#pragma once

#include <cstdint>
#include <vector>

#include "base/geometry/neighbor_grid.h"
#include "base/geometry/strands.h"
#include "solver/terms/cohesion.h"

namespace wetcurl {

class CohesionPass {
  public:
    // `volume`, `saturation` (strand, particle): V_j = m_j / rho [m^3] and sigma_j.
    CohesionPass(const Cohesion& term, int strands, int particles, const std::vector<float>& volume,
                 const std::vector<float>& saturation);

    // Displayed positions p^w of positions p. Roots stay.
    void apply(const Strands& p, Strands& displayed);

    double neighbours_mean() const {
        return start_.size() < 2 ? 0 : double(start_.back()) / double(start_.size() - 1);
    }
    double list_seconds() const { return list_seconds_; }  // of the last call, building lists
    size_t bytes() const;

  private:
    void build_lists(const Strands& p);
    Vec3f displacement(size_t k) const;
    void smooth_displacements(const Strands& p);
    Cohesion term_;
    int particles_;
    const std::vector<float>&volume_, &saturation_;
    NeighborGrid grid_;
    // In the order of the grid's cells; one more at the end has no volume and fills the last vector of a
    // list.
    struct Points {
        std::vector<float> x, y, z;
        void resize(size_t n) { x.resize(n), y.resize(n), z.resize(n); }
        Vec3f at(size_t k) const { return {x[k], y[k], z[k]}; }
        void set(size_t k, const Vec3f& p) { x[k] = p.x, y[k] = p.y, z[k] = p.z; }
    };
    Points now_, next_;
    std::vector<float> sorted_volume_, sorted_saturation_;
    std::vector<float> segment_, own_weight_;  // (strand) mean segment length [m], own_weight of it
    std::vector<uint32_t> start_, list_;  // neighbours of sorted particle k: list_[start_[k] .. start_[k+1])
    std::vector<uint32_t> rank_;          // of each particle (strand, particle) in the grid's order
    double list_seconds_ = 0;
};

}  // namespace wetcurl
