// Where the level sets of deforming solids are wanted.
#include "solver/solids/deforming_solids.h"

namespace wetcurl {

namespace {

// The part of `box` that hair can reach, a `least` [m] of it at any rate.
Bounds reachable(const Bounds& near, const Bounds& box, double least) {
    const auto held = [&](const Vec3d& x) { return lower(upper(x, box.low), box.high); };
    return {held(near.low), held(near.high) + Vec3d{least, least, least}};
}

}  // namespace

DeformingSurface surface_of(const Scene& scene, const Solid& solid) {
    const auto& adhesion = scene.term<Adhesion>();
    const double band = adhesion ? adhesion->h_a : 0;
    Mesh mesh = solid.deformation->at(0);
    scene.surface_vertices(solid, scene.begin(), mesh.vertices);
    if (scene.riding) {
        // A whole body is large, what hair reaches of it is not.
        const double of_part = usual_spacing(reachable(scene.riding->reach, solid.region, 0)),
                     usual = of_part > 0 ? of_part : usual_spacing(solid.region),
                     spacing = solid.spacing > 0 ? solid.spacing : usual;
        return {std::move(mesh), reachable(scene.riding->reach, solid.region, spacing), spacing, band};
    }
    const double spacing = solid.spacing > 0 ? solid.spacing : usual_spacing(solid.region);
    return {
        std::move(mesh),
        solid.attached ? reachable(reach_of_roots(scene.groom.rest), solid.region, spacing) : solid.region,
        spacing, band};
}

}  // namespace wetcurl
