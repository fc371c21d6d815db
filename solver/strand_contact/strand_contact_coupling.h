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
        state.for_each_particle([&](size_t id, size_t k, int lane) {
            LinkedParticle& p = links_.particles[id];
            p.mass = State::template lane_of<float>(state.mass[k], lane);
            if (!state.saturation.empty())
                p.saturation = State::template lane_of<float>(state.saturation[k], lane);
        });
    }
    // A frame begins: neighbours are found in its first substep.
    void begin_frame() { left_ = 0; }
    // Adds to what is given for the substep of dt [s] that follows by `scheme`.
    void evaluate(const ChainState<S>& state, const Bdf2<S>& scheme, double dt, GivenToChain<S>& given) {
        const StageTimer timer(seconds);
        auto expected = [&](size_t k) { return scheme.predicted(state.x[k], state.x_before[k], state.v[k]); };
        // From the first particle on: floats have no digits to spare far away.
        const Vec3<Plain<S>> zero = State::template lane_of<Plain<S>>(expected(0), 0);
        const Vec3<S> first{S(zero.x), S(zero.y), S(zero.z)};
        state.for_each_cell([&](size_t k, auto particle) {
            const Vec3<S> x = expected(k) - first, v = state.v[k];
            for (int lane = 0; lane < State::lanes; ++lane) {
                LinkedParticle& p = links_.particles[particle(lane)];
                p.x = State::template lane_of<float>(x, lane), p.v = State::template lane_of<float>(v, lane);
            }
        });
        if (!are_finite()) return;
        if (left_ == 0) links_.find(), left_ = substeps_;
        --left_;
        links_.evaluate(dt);
        state.for_each_cell([&](size_t k, auto particle) {
            for (int lane = 0; lane < State::lanes; ++lane) {
                const size_t id = particle(lane);
                State::put(force_[k], lane, cast<double>(links_.force()[id]));
                State::put(stiffness_[k], lane, double(links_.stiffness()[id]));
            }
            if (given.force) force_[k] += given.force[k];
            if (given.stiffness) stiffness_[k] += given.stiffness[k];
        });
        given.force = force_.data(), given.stiffness = stiffness_.data();
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
    using State = ChainState<S>;
    bool are_finite() const {
        return std::all_of(links_.particles.begin(), links_.particles.end(),
                           [](const LinkedParticle& p) { return std::isfinite(p.x.x + p.x.y + p.x.z); });
    }
    StrandLinks links_;
    const int substeps_;
    int left_ = 0;  // substeps until neighbours are found again
    double recorded_ = 0;
    std::vector<Vec3<S>> force_;
    std::vector<S> stiffness_;
};

}  // namespace wetcurl
