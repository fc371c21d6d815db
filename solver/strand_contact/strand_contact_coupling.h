// Contact between strands, once a substep: what the pass needs of the strands, and what it gives them.
#pragma once

#include "base/carried.h"
#include "solver/chain/chain_state.h"
#include "solver/strand_contact/strand_contact_pass.h"

namespace wetcurl {

template <class S>
class StrandContactCoupling {
  public:
    // For a scene with [strand_contact], which must outlive it.
    StrandContactCoupling(const Scene& scene, const ChainState<S>& state)
        : pass_(*scene.strand_contact, scene.groom.rest) {
        weigh(state);
    }
    // 1/m as strands feel it of each other; particles 0 and 1 go where the head takes them.
    void weigh(const ChainState<S>& state) {
        const size_t n = size_t(state.n);
        state.for_each_particle([&](size_t id, size_t k, int lane) {
            if (id % n > 1) pass_.inverse_mass[id] = 1 / state.template lane_of<float>(state.mass[k], lane);
        });
    }
    // Takes up where the strands are; false where they are too far gone.
    bool look(const ChainState<S>& state) {
        state.template unpack<float>(state.x, pass_.x.points);
        state.template unpack<float>(state.v, pass_.v.points);
        return is_finite(pass_.x.points);
    }
    // Impulses between strands at the end of a substep of dt [s] change the velocities of the history alike.
    // Seen: with its positions changed to match, hair at rest trembles three times as much.
    void push(ChainState<S>& state, double dt) {
        pass_.resolve(dt);
        const size_t n = size_t(state.n);
        state.for_each_lane([&](size_t id, size_t k, int lane) {
            if (id % n < 2) return;
            const Vec3d dv = cast<double>(pass_.v.points[id]);
            for (Vec3<S>* v : {&state.v[k], &state.v_before[k]})
                state.put(*v, lane, state.template lane_of<double>(*v, lane) + dv);
        });
    }
    // The order of neighbours, and so of sums, is that of the lists built last.
    void save(Carried& to) const { to["contact lists"] = pass_.built_at(); }
    void resume(const Carried& from) { pass_.build_at(from.at("contact lists")); }
    double neighbours_mean() const { return pass_.neighbours_mean(); }
    void list(BufferList& buffers) const { buffers.push_back({StrandContact::name, pass_.bytes()}); }
    double seconds = 0;  // in the frame at hand
    double work = 0;     // [J] while it is counted

  private:
    StrandContactPass pass_;
};

}  // namespace wetcurl
