// The pass of contact between strands, once a substep, over neighbour lists that hold until a particle has
// moved by half of their margin (Verlet 1967). Gathers only; each particle writes its own slot, so the result
// is the same for any number of threads, and the two of a pair compute the same impulse to the bit.
#pragma once

#include <cstdint>
#include <vector>

#include "base/geometry/neighbor_list.h"
#include "base/strands.h"
#include "solver/terms/strand_contact.h"

namespace wetcurl {

class StrandContactPass {
  public:
    // `rest`: strands as drawn, which must outlive the pass.
    StrandContactPass(const StrandContact& term, const Strands& rest);

    // (strand, particle) [1/kg]; 0 where a particle is held.
    std::vector<float> inverse_mass;
    // Where particles are [m], and their velocities [m/s]: `resolve` leaves what these change by.
    Strands x, v;
    // The impulses of all pairs in touch, over a step of dt [s].
    void resolve(double dt);

    // How often lists were built, and where particles were then (strand, particle, 3) [m], 0 before the
    // first; and lists as they were built there.
    std::vector<double> built_at() const;
    void build_at(const std::vector<double>& built);

    long lists_built() const { return lists_built_; }
    double neighbours_mean() const { return list_.neighbours_mean(); }  // within radius and margin
    size_t bytes() const;

  private:
    using S = Pack<float>;
    bool refresh();
    void build_lists();
    // Of cluster c: in each quad the contacts of one of its points; its impulse, and one number more.
    S contacts_of(size_t c) const;
    S impulses_on(size_t c, const StrandContact::Step& step) const;
    // Calls visit(first, neighbours' mask, x_i - x_j, d_ij²) for each run of cluster c.
    template <class Visit>
    void for_each_run(size_t c, Visit visit) const;
    // Calls visit(i, k) for each point of cluster c, its i-th.
    template <class Visit>
    void for_each_point(size_t c, Visit visit) const {
        for (size_t i = 0, k = c * NeighborList::cluster; i < NeighborList::cluster && k < grid_.size(); ++i)
            visit(int(i), k++);
    }

    const StrandContact term_;
    const Strands& rest_;
    NeighborGrid grid_;  // its points are the positions of the substep at hand
    NeighborList list_;
    // In the grid's order, as long as lists ask for.
    PointQuads searched_, velocity_, drawn_;
    std::vector<float> weight_, contacts_, any_;  // 1/m; pairs in touch; ones
    long lists_built_ = 0;
};

}  // namespace wetcurl
