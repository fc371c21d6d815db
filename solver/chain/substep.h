// A whole substep of a block of strands: which surfaces hold it, the step, its limits, contact and frames.
#pragma once

#include "solver/chain/chain_step.h"
#include "solver/compared/iben2013.h"

namespace wetcurl {

// What is the same for all blocks and substeps.
template <class T>
struct SubstepRules {
    ChainTerms terms;
    std::optional<Iben2013> iben;
    bool implicit;
    T spring_sum;
};

// In the place of a WorkMeter.
struct NoMeter {
    static constexpr int limiter = 0, solids = 0;
};

// `view`: the block's data, its given adhesion and the root's motion among them. `surfaces`: SolidsInALoop or
// what offers the same. The new state is left in step.x_before and step.v_before. Returns how many edges were
// held at their strain limit, over all lanes. `meter`: null, or what counts the work.
template <class S, class Surfaces, class Meter>
WETCURL_HD int take_substep(const SubstepRules<Plain<S>>& rules, BlockStep<S>& step, ChainView<S> view,
                            const NearestView<S>& near, const S* rest_depth, const Surfaces& surfaces,
                            ChainScratch<S>& scratch, Meter* meter) {
    using T = Plain<S>;
    const int n = step.n;
    const auto& adhesion = std::get<Slot<Adhesion>>(rules.terms);
    view.phi = near.phi, view.normal = near.normal, view.surface_velocity = near.velocity;
    view.touching = near.touching;
    auto before_forces = [&](const Vec3<S>* x, const Vec3<S>* v, int linearisations) {
        if (adhesion && !view.given_adhesion) surfaces.sample(n, x, near);
        if (linearisations > 0 || !scratch.hold) return;
        const S h = Bdf2<S>(step.dt, step.first).h;
        surfaces.expect([&](auto contact) {
            for (int i = 2; i < n; ++i) {
                const Hold<S> hold =
                    contact(i, rest_depth ? rest_depth[i] : S(0),
                            hold_stiffness(rules.spring_sum, h, view.mass[i]), x[i], v[i], step.pushed[i]);
                scratch.gap[i] = hold.gap;
                if (any_positive(step.pushed[i])) scratch.hold[i] = hold;
            }
        });
    };
    Quat<T> turn_left = Quat<T>::identity();  // of the frames, to where the step ends
    if (rules.implicit)
        implicit_step(rules.terms, step, view, scratch, before_forces);
    else
        explicit_step(rules.terms, step, view, scratch, before_forces), turn_left = step.root_turn;

    Vec3<S>*x = step.x_before, *x_old = step.x, *v = step.v_before, *v_old = step.v;
    if (rules.iben) rules.iben->limit_velocities(n, step.dt, x, v);
    view.x = x, view.v = v;
    if constexpr (!std::is_same_v<Meter, NoMeter>)
        if (meter) meter->add_step(step, view, turn_left, x_old, scratch);
    auto counted = [&](auto kind, auto act) {
        if constexpr (!std::is_same_v<Meter, NoMeter>)
            if (meter) return meter->add_change(kind, step, view, turn_left, act);
        act();
    };
    int limited = 0;
    const auto& limit = std::get<Slot<StrainLimit>>(rules.terms);
    if (limit && scratch.limit_edge)
        for (int i = 1; i + 1 < n; ++i)
            limited += count_lanes<S>(limit->holds(scratch.limit_edge[i], view.rest_length[i]));
    else if (limit)
        counted(Meter::limiter, [&] {
            Vec3<S>* unlimited = scratch.predicted_x;
            for (int i = 0; i < n; ++i) unlimited[i] = x[i];
            limited = limit_strain(n, view.rest_length, T(limit->most), x);
            for (int i = 2; i < n; ++i) {
                const Vec3<S> dx = x[i] - unlimited[i], dv = S(T(1 / step.dt)) * dx;
                x_old[i] += dx, v[i] += dv, v_old[i] += dv;
            }
        });
    surfaces.for_each_met(n, x, [&](const auto& solid, bool moves) {
        bool met = false;
        auto resolve = [&] {
            met = resolve_contact(solid, rules.implicit ? T(0) : solid.friction, n, rest_depth, scratch.gap,
                                  step.dt, view.mass, step.pushed, x, x_old, v, v_old);
        };
        if (moves)
            counted(Meter::solids, resolve);
        else
            resolve();
        return met;
    });
    if (adhesion) update_touching(n, view.phi, T(adhesion->h_a), near.touching);
    if (step.frame) transport_frames(n, step.frame, turn_left, x, step.frame);
    return limited;
}

}  // namespace wetcurl
