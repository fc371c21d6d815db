// Work that is done on hair from outside, substep by substep: what the energy of a driven run is measured
// against (EQUATIONS Sec. 8, S2). Counted only where asked for. Ours.
#pragma once

#include "solver/terms/list.h"

namespace wetcurl {

// [J], summed over strands.
struct Work {
    double roots = 0;    // of the forces that move particles 0 and 1 as prescribed
    double solids = 0;   // of moving surfaces: a still one may take energy, never give it
    double terms = 0;    // of forces that keep no energy: adhesion, and drag by the root's rigid motion
    double limiter = 0;  // of the strain limiter: no cause outside, so not in `given`
    double given() const { return roots + solids + terms; }
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
    const auto& bend = std::get<std::optional<Bend>>(terms);
    const auto& twist = std::get<std::optional<Twist>>(terms);
    if (!bend || c.n < 3) return S(0);
    S slope, bound;
    bend_by_turn(*bend, c.frame[0], c.target[1], edge(c, 1), slope, bound);
    if (twist)
        slope -=
            twist->stiffness(c.rest_length[1]) * Twist::HalfAngle<S>(c.frame[0], c.frame[1]).sine_of_whole();
    return slope;
}
// How far that frame was turned about its own edge, beyond what positions say [rad]; up to half a turn.
template <class S>
S root_spin(const Quat<S>& frame_before, const Quat<S>& frame) {
    return S(2) * Twist::HalfAngle<S>(transported(frame_before, frame_direction(frame)), frame).sine;
}

// Of the terms that keep no energy, on free particles that came from `from` to c.x within dt. `force` (n) is
// scratch.
template <class S>
S work_of_terms(const ChainTerms& terms, const ChainView<S>& c, Plain<S> dt, const Vec3<S>* from,
                Vec3<S>* force) {
    const ChainSystem<S> forces{S(dt), force, nullptr, nullptr, nullptr};
    auto apply = [&](const auto& term) {
        if (!term) return false;
        std::fill_n(force, c.n, Vec3<S>{S(0), S(0), S(0)});
        assemble(*term, c, forces);
        return true;
    };
    S sum(0);
    if (apply(std::get<std::optional<Adhesion>>(terms)))
        for (int i = 2; i < c.n; ++i) sum += dot(force[i], c.x[i] - from[i]);
    // f.(v - v_rigid) is lost to drag; the rest of f.v is the driver's.
    if (apply(std::get<std::optional<Stiffness>>(terms)))
        for (int i = 2; i < c.n; ++i)
            sum += S(dt) * dot(force[i], c.drift + cross(c.turn, c.x[i] - c.turn_center));
    return sum;
}

}  // namespace wetcurl
