// Which forces a scene names, and their sum.
#include "solver/pair_forces/pair_forces_coupling.h"

#include "solver/pair_forces/cohesion_forces.h"

namespace wetcurl {

namespace {

// The explicit forces of several methods, which act at once.
class SummedForces final : public PairForces {
  public:
    explicit SummedForces(std::vector<std::unique_ptr<PairForces>> parts) : parts_(std::move(parts)) {}

    void evaluate(const std::vector<Vec3d>& x, double time, std::vector<Vec3d>& force) override {
        force.assign(x.size(), {0, 0, 0});
        for (const auto& part : parts_) {
            part->evaluate(x, time, of_part_);
            for (size_t i = 0; i < x.size(); ++i) force[i] += of_part_[i];
        }
    }
    double potential(const std::vector<Vec3d>& x, double time) override {
        double sum = 0;
        for (const auto& part : parts_) sum += part->potential(x, time);
        return sum;
    }
    double given(const std::vector<Vec3d>& x, double from, double to) override {
        double sum = 0;
        for (const auto& part : parts_) sum += part->given(x, from, to);
        return sum;
    }
    double neighbours_mean() const override {
        double sum = 0;
        for (const auto& part : parts_) sum += part->neighbours_mean();
        return sum;
    }
    size_t bytes() const override {
        size_t sum = of_part_.capacity() * sizeof(Vec3d);
        for (const auto& part : parts_) sum += part->bytes();
        return sum;
    }

  private:
    const std::vector<std::unique_ptr<PairForces>> parts_;
    std::vector<Vec3d> of_part_;  // (strand, particle) [N]
};

}  // namespace

std::unique_ptr<PairForces> make_pair_forces(const Scene& scene) {
    std::vector<std::unique_ptr<PairForces>> parts;
    for_each_pair_force(scene, [&]<class Term>(const Term& term) {
        if constexpr (std::is_same_v<Term, Cohesion>)
            parts.push_back(make_cohesion_forces(scene));
        else
            parts.push_back(term.forces(scene));
    });
    if (parts.empty()) return nullptr;
    if (parts.size() == 1) return std::move(parts.front());
    return std::make_unique<SummedForces>(std::move(parts));
}

}  // namespace wetcurl
