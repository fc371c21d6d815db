// Springs between pairs, weaker as they part.
#include "solver/pair_forces/cohesion_forces.h"

namespace wetcurl {

namespace {

class CohesionForces final : public PairForces {
  public:
    explicit CohesionForces(const Scene& scene)
        : term_(*scene.cohesion), mass_(particle_masses(scene)), pairs_(scene, term_.h_c) {}

    const char* name() const override { return cohesion_in_the_solve; }
    void evaluate(const std::vector<Vec3d>& x, double, std::vector<Vec3d>& force) override {
        pairs_.find(x);
        force.assign(x.size(), {0, 0, 0}), stiffness_.assign(x.size(), 0);
        pairs_.for_each([&](size_t i, size_t j) {
            const Vec3d d = x[j] - x[i];
            const double k = term_.pair_spring(norm(d), mass_[i], mass_[j], wet(i, j));
            force[i] += k * d;
            stiffness_[i] += Cohesion::outweighed * k;
        });
    }
    const std::vector<double>* stiffness() const override { return &stiffness_; }
    double potential(const std::vector<Vec3d>& x, double) override {
        pairs_.find(x);
        return pairs_.sum([&](size_t i, size_t j) {
            return term_.pair_energy(norm(x[i] - x[j]), mass_[i], mass_[j], wet(i, j));
        });
    }
    double neighbours_mean() const override { return pairs_.neighbours_mean(); }
    size_t bytes() const override {
        return (mass_.capacity() + stiffness_.capacity()) * sizeof(double) + pairs_.bytes();
    }

  private:
    double wet(size_t i, size_t j) const { return pairs_.saturation(i) * pairs_.saturation(j); }
    const Cohesion term_;
    const std::vector<double> mass_;  // (strand, particle) [kg]
    NeighbourPairs pairs_;
    std::vector<double> stiffness_;
};

}  // namespace

std::unique_ptr<PairForces> make_cohesion_forces(const Scene& scene) {
    return std::make_unique<CohesionForces>(scene);
}

}  // namespace wetcurl
