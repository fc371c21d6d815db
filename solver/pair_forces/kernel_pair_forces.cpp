// Potential and memory of forces between strands.
#include "solver/pair_forces/kernel_pair_forces.h"

namespace wetcurl {

KernelPairForces::KernelPairForces(const Scene& scene, double strength, double radius,
                                   double (*kernel)(double r, double h))
    : mass_(particle_masses(scene)),
      pairs_(scene, radius),
      strength_(strength),
      kernel_sum_(kernel, radius) {}

double KernelPairForces::potential(const std::vector<Vec3d>& x, double) {
    pairs_.find(x);
    return pairs_.sum([&](size_t i, size_t j) {
        return akinci2013::pair_energy(strength_, pairs_.saturation(i), pairs_.saturation(j), mass_[i],
                                       mass_[j], kernel_sum_(norm(x[i] - x[j])));
    });
}

size_t KernelPairForces::bytes() const {
    return mass_.capacity() * sizeof(double) + pairs_.bytes() + kernel_sum_.bytes();
}

}  // namespace wetcurl
