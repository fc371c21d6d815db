// The level sets of a scene's deforming solids, rebuilt once a frame: a block of strands goes through all
// substeps of a frame at once, and between the frame's ends phi is linear in time. Ours.
#pragma once

#include <vector>

#include "base/geometry/moving_level_set.h"
#include "solver/scene.h"

namespace wetcurl {

class DeformingSolids {
  public:
    // At rest as at time 0. The scene must outlive it.
    explicit DeformingSolids(const Scene& scene);
    // All is held as it is at `time` [s].
    void hold(double time);
    // Rebuilds them for a span of time [s] of so many substeps.
    void advance(double from, double to, int substeps);
    // A view of each deforming solid in the scene's order, where `substeps` of the span are done. Valid until
    // the next hold or advance.
    const MovingGrid* after(int substeps) const { return &views_[size_t(substeps) * level_sets_.size()]; }
    // The same at the span's end.
    const MovingGrid* at_end() const { return &views_[views_.size() - level_sets_.size()]; }

    const std::vector<MovingLevelSet>& level_sets() const { return level_sets_; }
    size_t bytes() const;

  private:
    void lay_views(int substeps);
    std::vector<const Solid*> solids_;  // those that deform
    std::vector<MovingLevelSet> level_sets_;
    std::vector<MovingGrid> views_;  // (substep and one, solid)
};

}  // namespace wetcurl
