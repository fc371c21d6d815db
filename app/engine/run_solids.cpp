// The solids of a run, rebuilt from the scene text in its cache.
#include "app/engine/run_solids.h"

#include <algorithm>
#include <memory>

#include "app/engine/run_of_scene.h"
#include "solver/solids/deforming_solids.h"

namespace wetcurl {

std::vector<PosedMesh> solids_of(const RunHeader& header, const RunFrame& frame, double time) {
    std::vector<PosedMesh> out;
    for (const auto& solid : scene_of_run(header)->solids)
        out.push_back({solid.deformation ? solid.deformation->at(time) : triangulated(solid.shape),
                       solid.at(time, frame.head)});
    return out;
}

std::function<float(const Vec3f&, const Pose&, double)> solid_distance_of(const RunHeader& header,
                                                                          bool loose) {
    const auto scene = scene_of_run(header);
    const auto counts = [loose](const Solid& solid) { return !(loose && solid.attached); };
    if (std::none_of(scene->solids.begin(), scene->solids.end(), counts)) return {};
    std::shared_ptr<DeformingSolids> surfaces;
    if (scene->has_deforming_solid()) surfaces = std::make_shared<DeformingSolids>(*scene);
    return [scene, surfaces, counts, held = 0.0](const Vec3f& x, const Pose& head, double time) mutable {
        if (surfaces && time != held) surfaces->hold(held = time);
        const MovingGrid* surface = surfaces ? surfaces->at_end() : nullptr;
        float nearest = 1e9f;
        for (const auto& solid : scene->solids) {
            const Pose pose =
                solid.deformation ? scene->surface_frame(solid, time, head) : solid.at(time, head);
            const Vec3f local = cast<float>(pose.inverse(cast<double>(x)));
            const float phi =
                solid.deformation ? distance(*surface++, local).phi : distance(solid.shape, local).phi;
            if (counts(solid)) nearest = std::min(nearest, phi);
        }
        return nearest;
    };
}

}  // namespace wetcurl
