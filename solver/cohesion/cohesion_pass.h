// The cohesion pass: Eq 10 over neighbour lists that are built once a frame, iterated by Jacobi.
// Gathers only; each particle writes its own slot, so the result is the same for any number of threads.
#pragma once

#include <omp.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "base/geometry/neighbor_list.h"
#include "base/strands.h"
#include "solver/cohesion/thinning.h"
#include "solver/terms/cohesion.h"

namespace wetcurl {

class CohesionPass {
  public:
    // `volume`, `saturation` (strand, particle): V_j = m_j / rho [m^3] and sigma_j.
    // `thinning`: for whom it is asked, all where the volumes change.
    CohesionPass(const Cohesion& term, int strands, const Thinning& thinning,
                 const std::vector<float>& volume, const std::vector<float>& saturation);

    // Positions p become displayed positions p^w. Roots stay. finish(strand, x, edges) has the last word on a
    // strand's x (particle); edges (particle): how long the one to each is in p [m], 0 at the root.
    template <class Finish>
    void apply(Strands& p, Finish finish) {
        draw_together(p);
        edges_.resize(size_t(omp_get_max_threads()));
#pragma omp parallel
        {
            std::vector<float>& edges = edges_[size_t(omp_get_thread_num())];
            edges.resize(size_t(p.particles));
#pragma omp for schedule(static)
            for (int s = 0; s < strands_; ++s) {
                show(s, p.strand(s), edges.data());
                finish(s, p.strand(s), edges.data());
            }
        }
    }
    void apply(Strands& p) {
        apply(p, [](int, Vec3f*, const float*) {});
    }

    double neighbours_mean() const { return list_.neighbours_mean(); }
    double list_seconds() const { return list_seconds_; }  // of the last call, building lists
    size_t bytes() const;

  private:
    void build_lists(const Strands& p, const Strands& whole);
    void add_up(size_t c);
    void move_strands(const Cohesion& sweep);
    // All sweeps.
    void draw_together(const Strands& p);
    // After the last one: a strand's x (particle) become p^w, with its edges held, of which `edges` tells.
    void show(int strand, Vec3f* x, float* edges) const;
    Cohesion term_;
    Thinning thinning_;
    int strands_, particles_;                                      // for whom Eq 10 is asked
    std::optional<ThinnedWater> water_;                            // where not all are asked
    const std::vector<float>&own_volume_, &volume_, &saturation_;  // volume: of what a particle stands for
    Strands thinned_;
    NeighborGrid grid_;  // its points are the positions of the pass at hand
    NeighborList list_;
    // In the grid's order, as long as lists ask for; V_j is the number beside each of the grid's points.
    std::vector<Cohesion::Sums<float>> sums_;  // of the pass at hand
    std::vector<float> sorted_wet_volume_;     // sigma_j V_j
    std::vector<uint32_t> rank_;               // of each particle (strand, particle) in the grid's order
    std::vector<float> segment_, own_weight_;  // (strand) mean segment length [m], own_weight of it
    // (thread, particle) a lane a strand: how the pass at hand moves it, and what that comes of.
    struct Moved {
        Vec3<Pack<float>> by;
        Pack<float> weight, own;
    };
    std::vector<std::vector<Moved>> moved_;
    std::vector<std::vector<float>> edges_;  // (thread, particle)
    double list_seconds_ = 0;
};

}  // namespace wetcurl
