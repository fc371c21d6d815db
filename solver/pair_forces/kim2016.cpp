// Kim 2016: densities, normals, forces, each one pass over pairs.
#include "solver/compared/kim2016.h"

#include "solver/pair_forces/kernel_pair_forces.h"

namespace wetcurl {

namespace {

// The potential is the cohesion's; the area force is the gradient of nothing, since normals follow all
// neighbours.
class KimForces final : public KernelPairForces {
  public:
    KimForces(const Kim2016& method, const Scene& scene)
        : KernelPairForces(scene, method.gamma, method.h, akinci2013::cohesion_kernel),
          method_(method),
          density_(mass_.size()),
          normal_(mass_.size()) {}

    void evaluate(const std::vector<Vec3d>& x, double, std::vector<Vec3d>& force) override {
        pairs_.find(x);
        pairs_.for_each(
            [&](size_t i) { density_[i] = method_.own_density(mass_[i]); },
            [&](size_t i, size_t j) { density_[i] += method_.density_part(x[i] - x[j], mass_[j]); });
        pairs_.for_each(
            [&](size_t i) {
                normal_[i] = {0, 0, 0};
            },
            [&](size_t i, size_t j) {
                normal_[i] += pairs_.saturation(j) * method_.normal_part(x[i] - x[j], mass_[j] / density_[j]);
            });
        force.assign(x.size(), {0, 0, 0});
        pairs_.for_each([&](size_t i, size_t j) {
            force[i] += method_.pair_force(x[i] - x[j], normal_[i] - normal_[j], mass_[i], mass_[j],
                                           pairs_.saturation(i) * pairs_.saturation(j));
        });
    }
    size_t bytes() const override {
        return KernelPairForces::bytes() + density_.capacity() * sizeof(double) +
               normal_.capacity() * sizeof(Vec3d);
    }

  private:
    const Kim2016 method_;
    std::vector<double> density_;  // [kg/m^3], of wet hair on other strands and the particle itself
    std::vector<Vec3d> normal_;
};

}  // namespace

std::unique_ptr<PairForces> Kim2016::forces(const Scene& scene) const {
    return std::make_unique<KimForces>(*this, scene);
}

}  // namespace wetcurl
