// Displayed positions.
#include "solver/cohesion/display.h"

#include <omp.h>

#include "solver/scene/rest_state.h"
#include "solver/solids/contact.h"
#include "solver/solids/rest_depths.h"

namespace wetcurl {

Display::Display(const Scene& scene, const std::vector<float>& saturation)
    : scene_(scene),
      saturation_(saturation),
      volume_(volumes_of(scene)),
      rest_depth_(rest_depths_of(scene)),
      cohesion_(*scene.cohesion, scene.groom.rest.count, Thinning(scene.groom.rest, *scene.cohesion), volume_,
                saturation) {
    for (const Solid& solid : scene.solids)
        shapes_.push_back(solid.deformation ? ShapeView{ShapeView::Kind::moving_grid, {}, {}, {}}
                                            : view_of(solid.shape));
    solids_.resize(shapes_.size());
}

void Display::take_up_water(const std::vector<double>& dry_mass) {
    for (size_t k = 0; k < volume_.size(); ++k)
        volume_[k] = float(scene_.wetness->wet_mass(dry_mass[k], saturation_[k]) / scene_.volume_density);
}

void Display::apply(Strands& p, const Pose& head, double time, const MovingGrid* surfaces) {
    const double begin = omp_get_wtime();
    for (size_t k = 0; k < shapes_.size(); ++k) {
        const Solid& solid = scene_.solids[k];
        if (solid.deformation) shapes_[k].grid = *surfaces++;
        const Pose pose = solid.deformation ? scene_.surface_frame(solid, time, head) : solid.at(time, head);
        solids_[k] = {&shapes_[k], cast<float>(pose.rotation), cast<float>(pose.translation), {}, {},
                      0.f,         solid.moves_with_roots()};
    }
    cohesion_.apply(p, [&](int s, Vec3f* x, const float* edges) {
        if (solids_.empty()) return;
        const float* depth = rest_depth_.empty() ? nullptr : &rest_depth_[size_t(s) * size_t(p.particles)];
        auto out = [&](int i) {
            return [&, i](const Vec3f& at) { return pushed_out(solids_, at, depth ? depth[i] : 0.f); };
        };
        for (int i = 1; i < p.particles; ++i) x[i] = out(i)(x[i]);
        for (int i = 1; i < p.particles; ++i)
            x[i] = led_around(x[i - 1], x[i], scene_.cohesion->torn_beyond(edges[i]), out(i));
    });
    seconds_ = omp_get_wtime() - begin;
}

size_t Display::bytes() const {
    return cohesion_.bytes() + (volume_.capacity() + rest_depth_.capacity()) * sizeof(float) +
           shapes_.capacity() * sizeof shapes_[0] + solids_.capacity() * sizeof solids_[0];
}

}  // namespace wetcurl
