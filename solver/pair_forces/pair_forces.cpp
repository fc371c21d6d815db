// The search for pairs.
#include "solver/pair_forces/pair_forces.h"

#include <algorithm>

#include "solver/scene/rest_state.h"

namespace wetcurl {

std::vector<double> particle_masses(const Scene& scene) {
    std::vector<double> mass;
    for (float volume : volumes_of(scene)) mass.push_back(double(volume) * scene.volume_density);
    return mass;
}

NeighbourPairs::NeighbourPairs(const Scene& scene, double radius)
    : saturation_(scene.saturation), particles_(scene.groom.rest.particles), radius_(float(radius)) {
    const size_t count = scene.groom.rest.points.size(), padded = count + NeighborList::padding;
    near_.resize(count), wet_.resize(padded);
}

void NeighbourPairs::find(const std::vector<Vec3d>& x) {
    // From one of them: single precision has no digits to spare far from the origin.
    for (size_t id = 0; id < x.size(); ++id) near_[id] = cast<float>(x[id] - x[0]);
    grid_.build(near_.data(), near_.size(), radius_);
    for (size_t k = 0; k < grid_.size(); ++k) {
        const size_t id = grid_.order()[k];
        grid_.points().set_group(k, uint32_t(id) / uint32_t(particles_));
        wet_[k] = saturation_[id];
    }
    list_.build(grid_, wet_, radius_);
}

size_t NeighbourPairs::bytes() const {
    return near_.capacity() * sizeof(Vec3f) + wet_.capacity() * sizeof(float) + grid_.bytes() + list_.bytes();
}

}  // namespace wetcurl
