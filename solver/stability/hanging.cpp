// S4: a straight strand let go of, over stiffnesses and steps: how it falls, and what shape it hangs in.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "solver/stability/cases.h"

namespace wetcurl::stability {

namespace {

// The hanging chain: edge i of a straight strand extended by s_i, where stretch, bend and core carry the
// weight w_i below it: (k_s + k_b) s + k_c D^T D s = w with the core's filter D. Edge 0 is the root's.
Points hanging(const Scene& scene) {
    const int edges = particles - 1;
    const StrandRest rest = rest_state_of(scene, 0);
    Eigen::MatrixXd k = Eigen::MatrixXd::Zero(edges, edges);
    if (const auto& core = scene.term<Core>()) {
        Eigen::MatrixXd d(edges, edges);
        for (int column = 0; column < edges; ++column)
            smooth_edges<double>(
                edges, core->beta,
                [&](int i) {
                    return Vec3d{i == column ? 1.0 : 0.0, 0, 0};
                },
                [&](int i, const Vec3d& v) { d(i, column) = v.x; });
        // As printed the core's force is on its own edge alone.
        k = core->k_c * (core->printed ? d : Eigen::MatrixXd(d.transpose() * d));
    }
    for (int i = 0; i < edges; ++i)
        k(i, i) += rest.springs.empty() ? scene.term<Stretch>()->k_s + scene.term<Bend>()->k_b
                                        : rest.springs.stretch[size_t(i)] + rest.springs.bend[size_t(i)];
    Eigen::VectorXd w = Eigen::VectorXd::Zero(edges);
    double below = 0;
    for (int i = edges - 1; i >= 1; --i) w[i] = (below += rest.mass[size_t(i) + 1]) * 9.81;
    const Eigen::VectorXd s = k.bottomRightCorner(edges - 1, edges - 1).ldlt().solve(w.tail(edges - 1));
    Points p{rest.start[0], rest.start[1]};
    for (int i = 1; i < edges; ++i) {
        double extension = s[i - 1];
        const double l = rest.rest_length[size_t(i)];
        if (const auto& limit = scene.term<StrainLimit>()) extension = std::min(extension, limit->most * l);
        p.push_back(p.back() + Vec3d{0, -(l + extension), 0});
    }
    return p;
}

// Of the fall, by ours in short steps [J].
double converged_kinetic(double k_over_m, double seconds) {
    const StabilityMethod& ours = stability_methods().front();
    Trial trial(ours,
                scene_of(StrandSetup{.shapes = {straight}, .k_over_m = k_over_m, .dt = 1.0 / 9600}, ours));
    trial.advance_for(seconds);
    return trial.most_kinetic;
}

}  // namespace

Cases stiffness_by_step(const Battery& b, double k_over_m) {
    Cases out;
    const double swing = slowest_swing(b, k_over_m),
                 seconds = std::clamp(std::numbers::pi / swing, 1.0, 10.0);
    const double reference =
        k_over_m < 1e5 && !(b.method.fibre > 0) ? converged_kinetic(k_over_m, seconds) : 0;
    for (double dt : b.some({1.0 / 24, 1.0 / 240, 1.0 / 2400}, {1.0 / 24, 1.0 / 240}))
        for (double limiter : {0.0, 0.1}) {
            StabilityCase c =
                b.named("S4", "released to hang", {{"k_over_m", k_over_m}, {"dt", dt}, {"limiter", limiter}});
            StrandSetup setup{.shapes = {straight}, .k_over_m = k_over_m, .dt = dt, .limiter = limiter};
            Trial falling(b.method, scene_of(setup, b.method));
            falling.advance_for(seconds);
            falling.report(c);
            const double allowed = reference > 0 ? 1.1 * reference : 20 * falling.weight_length();
            c.kinetic_ratio = falling.finite ? falling.most_kinetic / allowed : unbounded;
            c.measured.emplace_back("kinetic_over_weight", falling.most_kinetic / falling.weight_length());

            if (!b.method.takes_drag) {
                c.passed = c.finite && c.kinetic_ratio <= 1;
                out.push_back(c);
                continue;
            }
            setup.drag = critical_drag(swing);
            Trial settling(b.method, scene_of(setup, b.method));
            settling.advance_for(std::max(12 / swing, 1.5));
            c.finite = c.finite && settling.finite;
            // Of the length that it hangs at: the softest is stretched to hundreds of its own.
            const Points shape = hanging(settling.scene());
            c.rest_error = farthest(settling.simulation().state().x, shape) /
                           arc_length(shape.data(), int(shape.size()));
            c.passed = c.finite && c.kinetic_ratio <= 1 && c.rest_error < 0.01;
            out.push_back(c);
        }
    return out;
}

}  // namespace wetcurl::stability
