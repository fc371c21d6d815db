// Forces on all strands at once, taken anew once a substep: those of compared methods, or cohesion's.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "solver/chain/chain_state.h"
#include "solver/chain/chain_step.h"
#include "solver/pair_forces/pair_forces.h"

namespace wetcurl {

// Calls use(term) with the cohesion or else with each compared method whose forces a scene names.
template <class Use>
void for_each_pair_force(const Scene& scene, Use use) {
    if (scene.cohesion && scene.cohesion->strength > 0) return use(*scene.cohesion);
    for_each_present(scene.baselines, [&](const auto& method) {
        if constexpr (requires { method.forces(scene); }) use(method);
    });
}
inline bool has_pair_forces(const Scene& scene) {
    bool any = false;
    for_each_pair_force(scene, [&](const auto&) { any = true; });
    return any;
}
// The sum of them; null where the scene names none. The scene must outlive it.
std::unique_ptr<PairForces> make_pair_forces(const Scene& scene);

template <class S>
class PairForcesCoupling {
  public:
    // For a scene that names some, which must outlive it.
    PairForcesCoupling(const Scene& scene, const ChainState<S>& state)
        : method_(make_pair_forces(scene)), given_(state.x.size(), {S(0), S(0), S(0)}) {}

    // For the substep that follows `time` [s] by `scheme`; `counted`: so is the work that solids do through
    // them. Explicit forces are those of the positions now, others of those that the scheme expects.
    void evaluate(const ChainState<S>& state, const Bdf2<S>& scheme, double time, double dt, bool counted) {
        const StageTimer timer(seconds);
        if (method_->stiffness()) {
            expected_.resize(state.x.size());
            for (size_t k = 0; k < expected_.size(); ++k)
                expected_[k] = scheme.predicted(state.x[k], state.x_before[k], state.v[k]);
        }
        state.template unpack<double>(expected_.empty() ? state.x : expected_, x_);
        if (!is_finite(x_)) return;
        method_->evaluate(x_, time, force_);
        if (counted) work += method_->given(x_, time, time + dt);
        state.for_each_lane([&](size_t id, size_t k, int lane) { state.put(given_[k], lane, force_[id]); });
        if (const auto* stiffness = method_->stiffness()) {
            stiffness_.resize(given_.size(), S(0));
            state.for_each_lane(
                [&](size_t id, size_t k, int lane) { state.put(stiffness_[k], lane, (*stiffness)[id]); });
        }
    }
    // [J] where the strands are; NaN where they are too far gone to tell.
    template <class H>
    double potential(const H& hair, double time) const {
        hair.fetch();
        std::vector<Vec3d> x;
        hair.state.template unpack<double>(hair.state.x, x);
        return is_finite(x) ? method_->potential(x, time) : NAN;
    }
    // The same for a run to keep, in two halves as a snapshot.
    template <class H>
    void begin_record(const H& hair, double time) {
        recorded_ = potential(hair, time);
    }
    double recorded() const { return recorded_; }
    const Vec3<S>* force() const { return given_.data(); }  // (block, particle) [N]
    // (block, particle) [N/m]; null: explicit forces.
    const S* stiffness() const { return stiffness_.empty() ? nullptr : stiffness_.data(); }
    const char* name() const { return method_->name(); }
    double neighbours_mean() const { return method_->neighbours_mean(); }
    void list(BufferList& buffers) const {
        const std::string name = method_->name();
        add_buffer(buffers, name + ": forces", given_), add_buffer(buffers, name + ": stiffness", stiffness_);
        add_buffer(buffers, name + ": expected positions", expected_);
        add_buffer(buffers, name + ": particles", x_), add_buffer(buffers, name + ": answers", force_);
        buffers.push_back({name + ": lists", method_->bytes()});
    }
    double seconds = 0;  // in the frame at hand
    double work = 0;     // [J] while it is counted

  private:
    std::unique_ptr<PairForces> method_;
    double recorded_ = 0;
    std::vector<Vec3<S>> given_, expected_;
    std::vector<S> stiffness_;
    std::vector<Vec3d> x_, force_;  // (strand, particle): what the method sees and gives
};

}  // namespace wetcurl
