// Where the level sets of deforming solids are wanted.
#include "solver/solids/deforming_solids.h"

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

}  // namespace

DeformingSurface surface_of(const Scene& scene, const Solid& solid) {
    const Bounds box = solid.deformation->box();
    const double spacing = solid.spacing > 0 ? solid.spacing : usual_spacing(box);
    const auto& adhesion = scene.term<Adhesion>();
    return {solid.deformation->at(0), solid.attached ? reachable(scene, box, spacing) : box, spacing,
            adhesion ? adhesion->h_a : 0};
}

}  // namespace wetcurl
