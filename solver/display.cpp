// Displayed positions.
#include "solver/display.h"

#include <omp.h>

#include "solver/passes/contact.h"
#include "solver/rest_state.h"

namespace wetcurl {

Display::Display(const Scene& scene, const std::vector<float>& saturation, double reach)
    : scene_(scene),
      saturation_(saturation),
      lends_(reach > 0),
      volume_(volumes_of(scene)),
      rest_depth_(rest_depths_of(scene)),
      cohesion_(*scene.cohesion, scene.groom.rest.count, Thinning(scene.groom.rest, scene.cohesion->spacing),
                volume_, saturation, float(reach)) {}

void Display::take_up_water(const std::vector<double>& dry_mass) {
    for (size_t k = 0; k < volume_.size(); ++k)
        volume_[k] = float(scene_.wetness->wet_mass(dry_mass[k], saturation_[k]) / scene_.volume_density);
}

void Display::apply(Strands& p, const Pose& head, double time, const MovingGrid* surfaces) {
    const double begin = omp_get_wtime();
    cohesion_.apply(p);
    auto project = [&](const auto* shape, const Solid& solid) {
        const Pose pose = solid.at(time, head);
        const PosedSolid<float, std::decay_t<decltype(*shape)>> posed{
            shape, cast<float>(pose.rotation), cast<float>(pose.translation), {}, {}, 0.f, solid.attached};
#pragma omp parallel for schedule(static)
        for (size_t k = 0; k < p.points.size(); ++k) {
            if (k % size_t(p.particles) == 0) continue;
            Vec3f& x = p.points[k];
            const auto d = distance_in_world(posed, x);
            const float allowed = solid.attached ? rest_depth_[k] : 0.f;
            x = pushed_out(x, d, allowed);
        }
    };
    for (const auto& solid : scene_.solids)
        if (solid.deformation)
            project(surfaces++, solid);
        else
            project(&solid.shape, solid);
    if (lends_) cohesion_.show_at(p);
    seconds_ = omp_get_wtime() - begin;
}

size_t Display::bytes() const {
    return cohesion_.bytes() + (volume_.capacity() + rest_depth_.capacity()) * sizeof(float);
}

}  // namespace wetcurl
