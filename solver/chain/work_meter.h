// Work that is done on hair from outside, substep by substep: what the energy of a driven run is measured
// against (S2 of the battery). Counted only where asked for.
#pragma once

#include "solver/chain/chain_state.h"
#include "solver/chain/chain_step.h"
#include "solver/chain/energies.h"

namespace wetcurl {

// [J], summed over strands.
struct Work {
    double roots = 0;   // of the forces that move particles 0 and 1 as prescribed
    double solids = 0;  // of moving surfaces: a still one may take energy, never give it
    double terms = 0;   // of forces that keep no energy: adhesion, and drag by the root's rigid motion
    double wind = 0;    // of moving air; what slips through it takes energy
    double water = 0;   // of water that comes, goes and runs on, and of what follows it
    // No cause outside, so not in `given`:
    double limiter = 0;  // of the strain limiter
    double forces = 0;   // of a compared method; where they have a potential, what that loses
    double given() const { return roots + solids + terms + wind + water; }
    Work& operator+=(const Work& b) {
        roots += b.roots, solids += b.solids, terms += b.terms, wind += b.wind, water += b.water;
        limiter += b.limiter, forces += b.forces;
        return *this;
    }
};

// Of the roots over one step: the mean of the reactions [N] at both ends of the step along the way between.
// One end alone would count -dt/2 m a² of every oscillation.
template <class S>
S work_of_roots(const Vec3<S>* reaction_before, const Vec3<S>* reaction, const Vec3<S>* from,
                const Vec3<S>* to) {
    S sum(0);
    for (int i = 0; i < 2; ++i) sum += S(0.5) * dot(reaction_before[i] + reaction[i], to[i] - from[i]);
    return sum;
}

// The torque [N m] that holds the frame of edge 0 against bend and twist at edge 1.
template <class S>
S root_torque(const ChainTerms& terms, const ChainView<S>& c) {
    const auto& bend = std::get<Slot<Bend>>(terms);
    const auto& twist = std::get<Slot<Twist>>(terms);
    if (!bend || c.n < 3) return S(0);
    S slope, bound;
    bend_by_turn(spring_of(c.bend_spring, 1, bend->k_b), c.frame[0], c.target[1], edge(c, 1), slope, bound);
    if (twist)
        slope -= twist->stiffness(own_of(c.twist_spring, 1), c.rest_length[1]) *
                 Twist::HalfAngle<S>(c.frame[0], c.frame[1]).sine_of_whole();
    return slope;
}
// How far that frame was turned about its own edge, beyond what positions say [rad]; up to half a turn.
template <class S>
S root_spin(const Quat<S>& frame_before, const Quat<S>& frame) {
    return S(2) * Twist::HalfAngle<S>(frame_before, frame).signed_sine();
}

// force (n) of one term alone that acts on particles; false: there is no such term.
template <class Term, class S>
bool forces_of(const ChainTerms& terms, const ChainView<S>& c, const S& h, Vec3<S>* force) {
    const auto& term = std::get<Slot<Term>>(terms);
    if (!term) return false;
    std::fill_n(force, c.n, Vec3<S>{S(0), S(0), S(0)});
    assemble(*term, c, ChainSystem<S>{h, ChainSystem<S>::whole, force, nullptr, nullptr, nullptr, nullptr});
    return true;
}

// Of the terms that keep no energy, on free particles that came from `from` to c.x within dt, in a scheme of
// step h. `force` (n) is scratch.
template <class S>
S work_of_terms(const ChainTerms& terms, const ChainView<S>& c, Plain<S> dt, const S& h, const Vec3<S>* from,
                Vec3<S>* force) {
    S sum(0);
    if (forces_of<Adhesion>(terms, c, h, force))
        for (int i = 2; i < c.n; ++i) sum += dot(force[i], c.x[i] - from[i]);
    // f.(v - v_rigid) is lost to drag; the rest of f.v is the driver's.
    if (forces_of<Stiffness>(terms, c, h, force))
        for (int i = 2; i < c.n; ++i)
            sum += S(dt) * dot(force[i], c.root_velocity + cross(c.root_spin, c.x[i] - c.root_center));
    return sum;
}

// Of the air: f.(v - u) is lost to drag, the rest of f.v is given. Roots too, whose reactions bear their
// drag.
template <class S>
S work_of_wind(const ChainTerms& terms, const ChainView<S>& c, Plain<S> dt, Vec3<S>* force) {
    S sum(0);
    if (forces_of<AirDrag>(terms, c, S(dt), force))
        for (int i = 0; i < c.n; ++i) sum += S(dt) * dot(force[i], c.air[i]);
    return sum;
}

// Of forces (n) [N] along the ways from `from` to `to`, half: the mean over a step of what acts at its two
// ends is half of each along its way. Null: none.
template <class S>
S half_work_of(const Vec3<S>* force, int n, const Vec3<S>* from, const Vec3<S>* to) {
    S sum(0);
    for (int i = 0; force && i < n; ++i) sum += S(0.5) * dot(force[i], to[i] - from[i]);
    return sum;
}

// Of surfaces on the particles that they held within a step, which these leave at velocities v.
template <class S>
S work_of_holds(const BlockStep<S>& step, const Hold<S>* holds, const Vec3<S>* v) {
    S sum(0);
    // The momentum was given over h of the scheme, the way is that of dt.
    const S share = S(step.dt) / Bdf2<S>(step.dt, step.first).h;
    for (int i = 2; holds && i < step.n; ++i) {
        if (!any_positive(step.pushed[i])) continue;
        const Hold<S>& hold = holds[i];
        sum += share * dot(step.pushed[i] * hold.normal + friction_of(hold, v[i]), hold.surface_velocity);
    }
    return sum;
}

// Of the strain limit's springs, along the way from `from`.
template <class S>
S work_of_limit(const StrainLimit& limit, const ChainView<S>& c, const Vec3<S>* from) {
    S sum(0);
    for (int i = 1; i + 1 < c.n; ++i) {
        const S length = norm(edge(c, i)), over = maximum(limit.excess(length, c.rest_length[i]), S(0));
        sum -= limit.stiffness(c.mass[i + 1]) * over * (length - norm(from[i + 1] - from[i]));
    }
    return sum;
}

// Counts the work on one block of strands, of which the first `lanes` are real.
template <class S>
class WorkMeter {
  public:
    WorkMeter(const ChainTerms& terms, const Vec3d& gravity, int n, int lanes)
        : terms_(terms),
          gravity_(gravity),
          lanes_(lanes),
          with_frames_(std::get<Slot<Bend>>(terms).has_value()),
          frame_(with_frames_ ? size_t(n) : 0),
          force_(size_t(n)) {}

    static constexpr double Work::*limiter = &Work::limiter, Work::*solids = &Work::solids;

    // Before a step: where its reactions are to be put.
    Vec3<S>* begin(const BlockStep<S>& step) {
        if (with_frames_) root_frame_ = step.frame[0];
        if (!step.first) add_forces(step, step.x_before, step.x);
        return reaction_;
    }
    // The step took particles from `from` to view.x; `turn_left`: of its frames.
    void add_step(const BlockStep<S>& step, ChainView<S> view, const Quat<S>& turn_left, const Vec3<S>* from,
                  ChainScratch<S>& scratch) {
        if (step.first) std::copy_n(reaction_, 2, reaction_before_);
        work_.roots += sum_of_lanes(work_of_roots(reaction_before_, reaction_, from, view.x), lanes_);
        std::copy_n(reaction_, 2, reaction_before_);
        if (with_frames_) {
            carry_frames(step, view, turn_left);
            const S torque = root_torque(terms_, view);
            if (step.first) torque_before_ = torque;
            work_.roots +=
                sum_of_lanes(S(0.5) * (torque_before_ + torque) * root_spin(root_frame_, frame_[0]), lanes_);
            torque_before_ = torque;
        }
        const S h = scratch.solution ? Bdf2<S>(step.dt, step.first).h : S(step.dt);
        work_.terms += sum_of_lanes(work_of_terms(terms_, view, step.dt, h, from, force_.data()), lanes_);
        work_.wind += sum_of_lanes(work_of_wind(terms_, view, step.dt, force_.data()), lanes_);
        add_forces(step, from, view.x);
        work_.solids += sum_of_lanes(work_of_holds(step, scratch.hold, view.v), lanes_);
        const auto& limit = std::get<Slot<StrainLimit>>(terms_);
        if (limit && scratch.limit_edge)
            work_.limiter += sum_of_lanes(work_of_limit(*limit, view, from), lanes_);
    }
    // What `act`, which moves particles at the end of the step, adds to the energy is its work.
    template <class Act>
    void add_change(double Work::*kind, const BlockStep<S>& step, const ChainView<S>& view,
                    const Quat<S>& turn_left, Act act) {
        const double before = energy(step, view, turn_left);
        act();
        work_.*kind += energy(step, view, turn_left) - before;
    }
    const Work& work() const { return work_; }

  private:
    void add_forces(const BlockStep<S>& step, const Vec3<S>* from, const Vec3<S>* to) {
        work_.forces += sum_of_lanes(half_work_of(step.external, step.n, from, to), lanes_);
    }
    void carry_frames(const BlockStep<S>& step, ChainView<S>& view, const Quat<S>& turn_left) {
        transport_frames(step.n, step.frame, turn_left, view.x, frame_.data());
        view.frame = frame_.data();
    }
    double energy(const BlockStep<S>& step, ChainView<S> view, const Quat<S>& turn_left) {
        if (with_frames_) carry_frames(step, view, turn_left);
        S sum(0);
        for (const S& e : energies(terms_, view, gravity_)) sum += e;
        return sum_of_lanes(sum, lanes_);
    }
    ChainTerms terms_;
    Vec3d gravity_;
    int lanes_;
    bool with_frames_;
    Work work_;
    Vec3<S> reaction_[2]{}, reaction_before_[2]{};
    S torque_before_{};
    Quat<S> root_frame_{};  // at the step's begin
    std::vector<Quat<S>> frame_;
    std::vector<Vec3<S>> force_;
};

}  // namespace wetcurl
