// Rebuilding the level sets of deforming solids.
#include "solver/deforming_solids.h"

#include <limits>

namespace wetcurl {

namespace {

// The part of `box` that hair can reach from roots in the same frame, a `least` [m] of it at any rate: no
// strand is stretched by a quarter.
Bounds reachable(const Scene& scene, const Bounds& box, double least) {
    const Strands& hair = scene.groom.rest;
    constexpr double all = std::numeric_limits<double>::infinity();
    Bounds near{{all, all, all}, {-all, -all, -all}};
    for (int s = 0; s < hair.count; ++s) {
        const Vec3d root = cast<double>(hair.at(s, 0));
        const double r = 1.25 * arc_length(hair.strand(s), hair.particles);
        near.low = lower(near.low, root - Vec3d{r, r, r}),
        near.high = upper(near.high, root + Vec3d{r, r, r});
    }
    const auto held = [&](const Vec3d& x) { return lower(upper(x, box.low), box.high); };
    return {held(near.low), held(near.high) + Vec3d{least, least, least}};
}

MovingLevelSet level_set_of(const Scene& scene, const Solid& solid) {
    const Bounds box = solid.deformation->box();
    const double spacing = solid.spacing > 0 ? solid.spacing : usual_spacing(box);
    const auto& adhesion = scene.term<Adhesion>();
    return {solid.deformation->at(0), solid.attached ? reachable(scene, box, spacing) : box, spacing,
            adhesion ? adhesion->h_a : 0};
}

}  // namespace

DeformingSolids::DeformingSolids(const Scene& scene) {
    for (const auto& solid : scene.solids) {
        if (!solid.deformation) continue;
        solids_.push_back(&solid);
        level_sets_.push_back(level_set_of(scene, solid));
    }
    lay_views(1);
}

void DeformingSolids::hold(double time) {
    for (size_t k = 0; k < solids_.size(); ++k)
        level_sets_[k].hold(solids_[k]->deformation->at(time).vertices);
    lay_views(1);
}

void DeformingSolids::advance(double from, double to, int substeps) {
    for (size_t k = 0; k < solids_.size(); ++k)
        level_sets_[k].advance(solids_[k]->deformation->at(to).vertices, to - from);
    lay_views(substeps);
}

void DeformingSolids::lay_views(int substeps) {
    views_.clear();
    for (int done = 0; done <= substeps; ++done)
        for (const auto& level_set : level_sets_) views_.push_back(level_set.grid(double(done) / substeps));
}

size_t DeformingSolids::bytes() const {
    size_t sum = 0;
    for (const auto& level_set : level_sets_) sum += level_set.bytes();
    return sum;
}

}  // namespace wetcurl
