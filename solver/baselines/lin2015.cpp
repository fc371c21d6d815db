// Lin 2015: one pass over pairs.
#include "solver/baselines/lin2015.h"

#include "solver/baselines/particle_forces.h"

namespace wetcurl {

namespace {

class LinForces final : public ParticleForces {
  public:
    LinForces(const Lin2015& method, const Scene& scene)
        : method_(method),
          mass_(particle_masses(scene)),
          pairs_(scene, method.h),
          adhesion_(akinci2013::adhesion_kernel, method.h) {}

    void evaluate(const std::vector<Vec3d>& x, double, std::vector<Vec3d>& force) override {
        pairs_.find(x);
        force.assign(x.size(), {0, 0, 0});
        pairs_.for_each([](size_t) {},
                        [&](size_t i, size_t j) {
                            force[i] += method_.pair_force(x[i] - x[j], mass_[i], mass_[j],
                                                           pairs_.saturation(i) * pairs_.saturation(j));
                        },
                        [](size_t) {});
    }
    double potential(const std::vector<Vec3d>& x, double) override {
        pairs_.find(x);
        return pairs_.sum([&](size_t i, size_t j) {
            return -method_.beta * pairs_.saturation(i) * pairs_.saturation(j) * mass_[i] * mass_[j] *
                   adhesion_(norm(x[i] - x[j]));
        });
    }
    double neighbours_mean() const override { return pairs_.neighbours_mean(); }
    size_t bytes() const override {
        return mass_.capacity() * sizeof(double) + pairs_.bytes() + adhesion_.bytes();
    }

  private:
    const Lin2015 method_;
    const std::vector<double> mass_;
    StrandPairs pairs_;
    const akinci2013::KernelSum adhesion_;
};

}  // namespace

std::unique_ptr<ParticleForces> Lin2015::forces(const Scene& scene) const {
    return std::make_unique<LinForces>(*this, scene);
}

}  // namespace wetcurl
