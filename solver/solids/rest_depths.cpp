// Signed distances of the groom at rest.
#include "solver/solids/rest_depths.h"

#include <algorithm>

#include "solver/solids/deforming_solids.h"

namespace wetcurl {

std::vector<float> rest_depths_of(const Scene& scene) {
    const auto& points = scene.groom.rest.points;
    std::vector<float> depth(scene.has_solid_with_roots() ? points.size() : 0, 0.f);
    auto deepen = [&](const auto& shape) {
#pragma omp parallel for schedule(static)
        for (size_t k = 0; k < depth.size(); ++k)
            depth[k] = std::min(depth[k], float(distance(shape, cast<double>(points[k])).phi));
    };
    for (const auto& solid : scene.solids)
        if (solid.moves_with_roots() && !solid.deformation) deepen(solid.shape);
    if (depth.empty() || !scene.has_deforming_solid()) return depth;
    // By the level sets that contact will see.
    DeformingSolids surfaces(scene);
    if (scene.riding) surfaces.hold_at_rest();
    const MovingGrid* surface = surfaces.at_end();
    for (const auto& solid : scene.solids) {
        if (!solid.deformation) continue;
        if (solid.moves_with_roots()) deepen(*surface);
        ++surface;
    }
    return depth;
}

}  // namespace wetcurl
