// Contact between strands in a substep: what links need of the strands, and the forces that they give.
#pragma once

#include "base/carried.h"
#include "solver/chain/chain_stepper.h"
#include "solver/strand_contact/strand_links.h"

namespace wetcurl {

template <class S>
class StrandContactCoupling {
  public:
    // For a scene with [strand_contact], which must outlive it.
    StrandContactCoupling(const Scene& scene, const ChainState<S>& state)
        : links_(*scene.strand_contact, scene.groom.rest, longest_edge(scene.groom.rest)),
          substeps_(scene.integrator.substeps),
          force_(state.x.size(), {S(0), S(0), S(0)}),
          stiffness_(state.x.size(), S(0)) {
        take_water(state);
    }
    void take_water(const ChainState<S>& state) {
        state.template unpack<float>(state.mass, links_.mass);
        if (!state.saturation.empty()) state.template unpack<float>(state.saturation, links_.saturation);
    }
    // A frame begins: neighbours are found in its first substep.
    void begin_frame() { left_ = 0; }
    // Adds to what is given for the substep of dt [s] that follows by `scheme`.
    void evaluate(const ChainState<S>& state, const Bdf2<S>& scheme, double dt, GivenToChain<S>& given) {
        const StageTimer timer(seconds);
        auto expected = [&](size_t k, int lane) {
            return state.template lane_of<double>(scheme.predicted(state.x[k], state.x_before[k], state.v[k]),
                                                  lane);
        };
        const Vec3d first = expected(0, 0);  // floats have no digits to spare far away
        state.for_each_particle([&](size_t id, size_t k, int lane) {
            links_.x[id] = cast<float>(expected(k, lane) - first);
            links_.v[id] = state.template lane_of<float>(state.v[k], lane);
        });
        if (!is_finite(links_.x)) return;
        if (left_ == 0) links_.find(), left_ = substeps_;
        --left_;
        links_.evaluate(dt);
        state.for_each_lane([&](size_t id, size_t k, int lane) {
            Vec3d force = cast<double>(links_.force()[id]);
            double stiffness = double(links_.stiffness()[id]);
            if (given.force) force += state.template lane_of<double>(given.force[k], lane);
            if (given.stiffness) stiffness += state.template lane_of<double>(given.stiffness[k], lane);
            state.put(force_[k], lane, force), state.put(stiffness_[k], lane, stiffness);
        });
        given.force = force_.data(), given.stiffness = stiffness_.data();
    }
    // Whether the end of that substep is corrected; and that.
    bool corrects() const { return links_.corrects() && is_finite(links_.x); }
    void correct(ChainState<S>& state, const Bdf2<S>& scheme, double dt) {
        const StageTimer timer(seconds);
        state.for_each_particle([&](size_t id, size_t k, int lane) {
            const Vec3<S> change = state.v[k] - scheme.expected_velocity(state.v_before[k]);
            links_.v[id] = state.template lane_of<float>(change, lane);
        });
        links_.correct(dt);
        const double h = double(ChainState<S>::template lane_of<double>(scheme.h, 0));
        const size_t n = size_t(state.n);
        state.for_each_lane([&](size_t id, size_t k, int lane) {
            if (id % n < 2) return;
            const Vec3d dv = cast<double>(links_.v[id]);
            state.put(state.v[k], lane, state.template lane_of<double>(state.v[k], lane) + dv);
            state.put(state.x[k], lane, state.template lane_of<double>(state.x[k], lane) + h * dv);
        });
    }
    // [J] where the strands are; NaN where they are too far gone to tell.
    template <class H>
    double potential(const H& hair) const {
        hair.fetch();
        std::vector<Vec3d> x;
        hair.state.template unpack<double>(hair.state.x, x);
        return is_finite(x) ? links_.potential(x) : NAN;
    }
    // The same for a run to keep, in two halves as a snapshot.
    template <class H>
    void begin_record(const H& hair) {
        recorded_ = potential(hair);
    }
    double recorded() const { return recorded_; }
    void save(Carried& to) const { links_.save(to); }
    void resume(const Carried& from) { links_.resume(from); }
    double neighbours_mean() const { return links_.neighbours_mean(); }
    void list(BufferList& buffers) const {
        buffers.push_back({StrandContact::name, links_.bytes() + force_.capacity() * sizeof(force_[0]) +
                                                    stiffness_.capacity() * sizeof(stiffness_[0])});
    }
    double seconds = 0;  // in the frame at hand

  private:
    StrandLinks links_;
    const int substeps_;
    int left_ = 0;  // substeps until neighbours are found again
    double recorded_ = 0;
    std::vector<Vec3<S>> force_;
    std::vector<S> stiffness_;
};

}  // namespace wetcurl
