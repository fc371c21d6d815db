// Lin 2015: one pass over pairs.
#include "solver/compared/lin2015.h"

#include "solver/pair_forces/kernel_pair_forces.h"

namespace wetcurl {

namespace {

class LinForces final : public KernelPairForces {
  public:
    LinForces(const Lin2015& method, const Scene& scene)
        : KernelPairForces(scene, method.beta, method.h, akinci2013::adhesion_kernel), method_(method) {}

    void evaluate(const std::vector<Vec3d>& x, double, std::vector<Vec3d>& force) override {
        pairs_.find(x);
        force.assign(x.size(), {0, 0, 0});
        pairs_.for_each([&](size_t i, size_t j) {
            force[i] += method_.pair_force(x[i] - x[j], mass_[i], mass_[j],
                                           pairs_.saturation(i) * pairs_.saturation(j));
        });
    }

  private:
    const Lin2015 method_;
};

}  // namespace

std::unique_ptr<PairForces> Lin2015::forces(const Scene& scene) const {
    return std::make_unique<LinForces>(*this, scene);
}

}  // namespace wetcurl
