// The search for pairs, and the list of methods that bring forces.
#include "solver/baselines/particle_forces.h"

#include <algorithm>

#include "solver/rest_state.h"

namespace wetcurl {

std::vector<double> particle_masses(const Scene& scene) {
    std::vector<double> mass;
    for (float volume : volumes_of(scene)) mass.push_back(double(volume) * scene.volume_density);
    return mass;
}

std::unique_ptr<ParticleForces> make_particle_forces(const Scene& scene) {
    if (!scene.baseline) return nullptr;
    return std::visit(
        [&](const auto& method) -> std::unique_ptr<ParticleForces> {
            if constexpr (requires { method.forces(scene); }) return method.forces(scene);
            return nullptr;
        },
        *scene.baseline);
}

StrandPairs::StrandPairs(const Scene& scene, double radius)
    : saturation_(scene.saturation), particles_(scene.groom.rest.particles), radius_(float(radius)) {
    const size_t count = scene.groom.rest.points.size(), padded = count + size_t(lanes_of<float>);
    near_.resize(count), strand_.resize(padded), wet_.resize(padded);
}

void StrandPairs::find(const std::vector<Vec3d>& x) {
    // From one of them: single precision has no digits to spare far from the origin.
    for (size_t id = 0; id < x.size(); ++id) near_[id] = cast<float>(x[id] - x[0]);
    grid_.build(near_.data(), near_.size(), radius_);
    for (size_t k = 0; k < grid_.size(); ++k) {
        const size_t id = grid_.order()[k];
        strand_[k] = uint32_t(id) / uint32_t(particles_);
        wet_[k] = saturation_[id];
    }
    list_.build(grid_, strand_, wet_, radius_);
}

size_t StrandPairs::bytes() const {
    return near_.capacity() * sizeof(Vec3f) + strand_.capacity() * sizeof(uint32_t) +
           wet_.capacity() * sizeof(float) + grid_.bytes() + list_.bytes();
}

StrandForces::StrandForces(const Scene& scene, double strength, double radius,
                           double (*kernel)(double r, double h))
    : mass_(particle_masses(scene)),
      pairs_(scene, radius),
      strength_(strength),
      kernel_sum_(kernel, radius) {}

double StrandForces::potential(const std::vector<Vec3d>& x, double) {
    pairs_.find(x);
    return pairs_.sum([&](size_t i, size_t j) {
        return -strength_ * pairs_.saturation(i) * pairs_.saturation(j) * mass_[i] * mass_[j] *
               kernel_sum_(norm(x[i] - x[j]));
    });
}

size_t StrandForces::bytes() const {
    return mass_.capacity() * sizeof(double) + pairs_.bytes() + kernel_sum_.bytes();
}

}  // namespace wetcurl
