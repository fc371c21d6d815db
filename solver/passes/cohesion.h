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
    CohesionPass(const Cohesion& term, int strands, int particles, const std::vector<float>& volume, const std::vector<float>& saturation);

    // Displayed positions p^w of positions p. Roots stay.
    void apply(const Strands& p, Strands& displayed);

    double neighbours_mean() const { return sorted_.empty() ? 0 : double(list_.size()) / double(sorted_.size()); }
    double list_seconds() const { return list_seconds_; }  // of the last call, building lists
    size_t bytes() const;

  private:
    void build_lists(const Strands& p);
    void smooth_displacements(const Strands& p);
    Cohesion term_;
    int particles_;
    const std::vector<float>&volume_, &saturation_;
    NeighborGrid grid_;
    struct Particle {
        Vec3f p;
        float volume, saturation;
    };
    std::vector<Particle> sorted_, next_;  // in the order of the grid's cells
    std::vector<uint32_t> start_, list_;   // neighbours of sorted particle k: list_[start_[k] .. start_[k+1])
    std::vector<uint32_t> rank_;           // of each particle (strand, particle) in the grid's order
    double list_seconds_ = 0;
};

}  // namespace wetcurl
