// Springs between pairs, weaker as they part.
#include "solver/passes/cohesion_forces.h"

namespace wetcurl {

namespace {

class CohesionForces final : public ParticleForces {
  public:
    explicit CohesionForces(const Scene& scene)
        : term_(*scene.cohesion), mass_(particle_masses(scene)), pairs_(scene, term_.h_c) {}

    const char* name() const override { return "cohesion in the solve"; }
    void evaluate(const std::vector<Vec3d>& x, double, std::vector<Vec3d>& force) override {
        pairs_.find(x);
        force.assign(x.size(), {0, 0, 0}), stiffness_.assign(x.size(), 0);
        pairs_.for_each([&](size_t i, size_t j) {
            const Vec3d d = x[j] - x[i];
            const double k = spring(i, j) * kernel_shape(norm(d), term_.h_c);
            force[i] += k * d;
            // The potential is concave in the squared distance: springs of today's stiffness bound it, and
            // twice the sum at each end bounds those.
            stiffness_[i] += 2 * k;
        });
    }
    const std::vector<double>* stiffness() const override { return &stiffness_; }
    double potential(const std::vector<Vec3d>& x, double) override {
        pairs_.find(x);
        return pairs_.sum([&](size_t i, size_t j) {
            return -spring(i, j) * kernel_shape_moment(norm(x[i] - x[j]), term_.h_c);
        });
    }
    double neighbours_mean() const override { return pairs_.neighbours_mean(); }
    size_t bytes() const override {
        return (mass_.capacity() + stiffness_.capacity()) * sizeof(double) + pairs_.bytes();
    }

  private:
    double spring(size_t i, size_t j) const {
        return pairs_.saturation(i) * pairs_.saturation(j) * term_.spring(mass_[i], mass_[j]);
    }
    const Cohesion term_;
    const std::vector<double> mass_;  // (strand, particle) [kg]
    StrandPairs pairs_;
    std::vector<double> stiffness_;
};

}  // namespace

std::unique_ptr<ParticleForces> make_cohesion_forces(const Scene& scene) {
    return std::make_unique<CohesionForces>(scene);
}

}  // namespace wetcurl
