// Operations counted: each strand is stepped once by the solver's own templates over a counting number.
#include "app/bench_operations.h"

#include "app/counted.h"
#include "solver/chain_state.h"
#include "solver/passes/chain_step.h"
#include "solver/placement.h"
#include "solver/plan.h"

namespace wetcurl::bench {

using S = Counted;

double chain_operations(const Scene& scene, const SimulationState& from) {
    ChainState<S> state(scene);
    state.pack(from.x, state.x), state.pack(from.x_before, state.x_before);
    state.pack(from.v, state.v), state.pack(from.v_before, state.v_before);
    if (!state.frame.empty()) state.pack(from.frame, state.frame);
    if (!state.pushed.empty()) state.pack(from.pushed, state.pushed);
    const int n = state.n;
    const float dt = float(1 / (scene.fps * scene.integrator.substeps)),
                springs = float(spring_sum(scene.chain));
    const auto p = placement_at<float>(scene, from.time + double(dt), double(dt));
    ChainScratch<S> scratch;
    scratch.resize(n, scene.chain, true, !scene.solids.empty());
    Counted::operations = 0;
    for (int strand = 0; strand < state.strands; ++strand) {
        const size_t k = state.at(strand, 0);
        auto at = [&](auto& buffer) { return buffer.empty() ? nullptr : &buffer[k]; };
        Vec3<S> root[2];
        for (int i = 0; i < 2; ++i)
            root[i] =
                rotate(cast<S>(cast<float>(p.head.rotation)), state.root[size_t(strand) * 2 + size_t(i)]) +
                cast<S>(cast<float>(p.head.translation));
        BlockStep<S> step{n,
                          dt,
                          from.first,
                          at(state.x),
                          at(state.x_before),
                          at(state.v),
                          at(state.v_before),
                          root,
                          cast<float>(scene.integrator.gravity),
                          p.root_turn,
                          at(state.frame),
                          at(state.pushed)};
        step.share = float(predictor_share(scene));
        step.looks = scene.integrator.looks, step.turn = float(scene.integrator.turn);
        ChainView<S> view{};
        view.n = n;
        view.mass = at(state.mass), view.rest_length = at(state.rest_length), view.target = at(state.target);
        view.rest_core = at(state.rest_core), view.saturation = at(state.saturation);
        view.turn = cast<S>(p.turn), view.turn_center = cast<S>(p.turn_center), view.drift = cast<S>(p.drift);
        const S* rest_depth = at(state.rest_depth);
        implicit_step(scene.chain, step, view, scratch, [&](const Vec3<S>* x, const Vec3<S>* v, int looks) {
            for (int i = 2; looks == 0 && step.pushed && i < n; ++i)
                scratch.hold[size_t(i)] =
                    expected_contact(p.solids, rest_depth ? rest_depth[i] : S(0),
                                     hold_stiffness(springs, Bdf2<S>(dt, from.first).h, view.mass[i]), x[i],
                                     v[i], step.pushed[i]);
        });
        for (const auto& solid : p.solids)
            resolve_contact(solid, 0.f, n, rest_depth, scratch.clearance.data(), dt, view.mass, step.pushed,
                            step.x_before, step.x, step.v_before, step.v);
        if (step.frame) transport_frames(n, step.frame, Quat<float>::identity(), step.x_before, step.frame);
    }
    return double(Counted::operations) / (double(state.strands) * n);
}

double cohesion_operations(const Cohesion& term, double neighbours) {
    Counted::operations = 0;
    const Vec3<S> here{S(0), S(0), S(0)}, there{S(0.5 * term.h_c), S(0), S(0)};
    Cohesion::Sums<S> sums{here, S(0)};
    sums.add(there - here, S(term.h_c), S(1), S(1));
    const double of_a_neighbour = double(Counted::operations);
    Counted::operations = 0;
    const Vec3<S> moved = here + term.displacement(sums, S(1) * S(1));
    // Smoothed along the strand twice there and back, u += beta (u' - u), between a subtraction and a sum.
    S beta(term.coherence);
    Vec3<S> u = moved - here;
    for (int sweep = 0; term.coherence > 0 && sweep < 4; ++sweep) u = here + beta * (u - here);
    if (term.coherence > 0) u = here + u;
    return of_a_neighbour * neighbours + double(Counted::operations);
}

}  // namespace wetcurl::bench
