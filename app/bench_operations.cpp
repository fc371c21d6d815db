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
    const double dt = 1 / (scene.fps * scene.integrator.substeps);
    const auto rules = substep_rules<float>(scene);
    const auto p = placement_at<float>(scene, from.time + dt, dt);
    OwnScratch<S> scratch(n, scene.chain, true, !scene.solids.empty());
    Counted::operations = 0;
    for (int strand = 0; strand < state.strands; ++strand) {
        const size_t k = state.at(strand, 0);
        auto at = [&](auto& buffer) { return buffer.empty() ? nullptr : &buffer[k]; };
        Vec3<S> root[2];
        place_roots(p.head, &state.root[size_t(strand) * 2], root);
        BlockStep<S> step{n,
                          float(dt),
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
        take_substep(rules, step, view, {}, at(state.rest_depth),
                     SolidsInALoop<S, std::vector<PosedSolid<float>>>{p.solids}, scratch,
                     static_cast<NoMeter*>(nullptr));
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
