// The forces of a compared method on all strands, once a substep. Ours.
#pragma once

#include <cmath>
#include <memory>
#include <vector>

#include "solver/baselines/particle_forces.h"
#include "solver/chain_state.h"

namespace wetcurl {

template <class T>
class ComparedForces {
    using S = Pack<T>;

  public:
    ComparedForces(std::unique_ptr<ParticleForces> method, const ChainState<S>& state)
        : method_(std::move(method)), given_(state.x.size(), {S(0), S(0), S(0)}) {}

    // At the positions as they are at `time` [s], for the substep of dt [s] that follows; `counted`: so is
    // the work that solids do through them.
    void evaluate(const ChainState<S>& state, double time, double dt, bool counted) {
        const StageTimer timer(seconds);
        state.template unpack<double>(state.x, x_);
        if (!is_finite(x_)) return;
        method_->evaluate(x_, time, force_);
        if (counted) work += method_->given(x_, time, time + dt);
        state.for_each_particle(
            [&](size_t id, size_t k, int lane) { state.put(given_[k], lane, force_[id]); });
    }
    // [J] where the strands are; NaN where they are too far gone to tell.
    double potential(const ChainState<S>& state, double time) const {
        std::vector<Vec3d> x;
        state.template unpack<double>(state.x, x);
        return is_finite(x) ? method_->potential(x, time) : NAN;
    }
    const Vec3<S>* force() const { return given_.data(); }  // (block, particle) [N]
    double neighbours_mean() const { return method_->neighbours_mean(); }
    void list(BufferList& buffers) const {
        add_buffer(buffers, "baseline forces", given_), add_buffer(buffers, "baseline particles", x_);
        add_buffer(buffers, "baseline answers", force_);
        buffers.push_back({"baseline lists", method_->bytes()});
    }
    double seconds = 0;  // in the frame at hand
    double work = 0;     // [J] while it is counted

  private:
    std::unique_ptr<ParticleForces> method_;
    std::vector<Vec3<S>> given_;
    std::vector<Vec3d> x_, force_;  // (strand, particle): what the method sees and gives
};

}  // namespace wetcurl
