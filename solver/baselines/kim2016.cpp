// Kim 2016: densities, normals, forces, each one pass over pairs.
#include "solver/baselines/kim2016.h"

#include "solver/baselines/particle_forces.h"

namespace wetcurl {

namespace {

class KimForces final : public ParticleForces {
  public:
    KimForces(const Kim2016& method, const Scene& scene)
        : method_(method),
          mass_(particle_masses(scene)),
          pairs_(scene, method.h),
          density_(mass_.size()),
          normal_(mass_.size()),
          cohesion_(akinci2013::cohesion_kernel, method.h) {}

    void evaluate(const std::vector<Vec3d>& x, double, std::vector<Vec3d>& force) override {
        const double h = method_.h;
        const auto nothing = [](size_t) {};
        pairs_.find(x);
        pairs_.for_each([&](size_t i) { density_[i] = mass_[i] * kernel_at_zero(h); },
                        [&](size_t i, size_t j) { density_[i] += mass_[j] * kernel(norm(x[i] - x[j]), h); },
                        nothing);
        pairs_.for_each(
            [&](size_t i) {
                normal_[i] = {0, 0, 0};
            },
            [&](size_t i, size_t j) {
                normal_[i] += pairs_.saturation(j) * method_.normal_part(x[i] - x[j], mass_[j] / density_[j]);
            },
            nothing);
        force.assign(x.size(), {0, 0, 0});
        pairs_.for_each(
            nothing,
            [&](size_t i, size_t j) {
                force[i] += method_.pair_force(x[i] - x[j], normal_[i] - normal_[j], mass_[i], mass_[j],
                                               pairs_.saturation(i) * pairs_.saturation(j));
            },
            nothing);
    }
    // Of the cohesion; the area force is the gradient of nothing, since normals follow all neighbours.
    double potential(const std::vector<Vec3d>& x, double) override {
        pairs_.find(x);
        return pairs_.sum([&](size_t i, size_t j) {
            return -method_.gamma * pairs_.saturation(i) * pairs_.saturation(j) * mass_[i] * mass_[j] *
                   cohesion_(norm(x[i] - x[j]));
        });
    }
    double neighbours_mean() const override { return pairs_.neighbours_mean(); }
    size_t bytes() const override {
        return (mass_.capacity() + density_.capacity()) * sizeof(double) +
               normal_.capacity() * sizeof(Vec3d) + pairs_.bytes() + cohesion_.bytes();
    }

  private:
    const Kim2016 method_;
    const std::vector<double> mass_;
    StrandPairs pairs_;
    std::vector<double> density_;  // [kg/m^3], of wet hair on other strands and the particle itself
    std::vector<Vec3d> normal_;
    const akinci2013::KernelSum cohesion_;
};

}  // namespace

std::unique_ptr<ParticleForces> Kim2016::forces(const Scene& scene) const {
    return std::make_unique<KimForces>(*this, scene);
}

}  // namespace wetcurl
