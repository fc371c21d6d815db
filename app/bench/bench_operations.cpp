// Operations counted: each strand is stepped once by the solver's own templates over a counting number.
#include "app/bench/bench_operations.h"

#include "app/bench/flop_counter.h"
#include "solver/chain/chain_state.h"
#include "solver/chain/chain_step.h"
#include "solver/chain/scene_checks.h"
#include "solver/solids/posed_scene.h"

namespace wetcurl::bench {

using S = Counted;

double chain_operations(const Scene& scene, const SimulationState& from) {
    ChainState<S> state(scene);
    state.restore(from);
    const int n = state.n;
    const double dt = 1 / (scene.fps * scene.integrator.substeps);
    const auto rules = substep_rules<float>(scene);
    const auto p = posed_scene_at<float>(scene, from.time + dt, dt);
    OwnScratch<S> scratch(n, scene.chain, true, !scene.solids.empty());
    Counted::operations = 0;
    for (int strand = 0; strand < state.strands; ++strand) {
        const size_t k = state.at(strand, 0);
        auto at = [&](auto& buffer) { return buffer.empty() ? nullptr : &buffer[k]; };
        const auto of_root = cast<S>(p.roots.empty() ? p.head_motion : p.roots[size_t(strand)]);
        const Vec3<S>* in_frame = &state.root[size_t(strand) * 2];
        const Vec3<S> root[2] = {of_root(in_frame[0]), of_root(in_frame[1])};
        BlockStep<S> step{.n = n,
                          .dt = float(dt),
                          .first = from.first,
                          .x = at(state.x),
                          .x_before = at(state.x_before),
                          .v = at(state.v),
                          .v_before = at(state.v_before),
                          .root = root,
                          .gravity = cast<float>(scene.integrator.gravity),
                          .root_turn = of_root.turn,
                          .frame = at(state.frame),
                          .pushed = at(state.pushed)};
        step.share = float(predictor_share(scene));
        step.max_linearisations = scene.integrator.max_linearisations;
        step.relinearise_angle = float(scene.integrator.relinearise_angle);
        ChainView<S> view{};
        view.n = n;
        view.set_arrays(state.pointers(strand));
        view.set_root(of_root);
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
