// S6: orders of convergence in the step and in the number of particles.
#include <algorithm>
#include <cmath>

#include "solver/stability/cases.h"

namespace wetcurl::stability {

namespace {

double order_between(double coarse, double fine) { return std::log2(coarse / fine); }

Points swung(const Battery& b, double k_over_m, int steps) {
    const StrandSetup setup{.shapes = {helix_points(20, 0.1, 0.006, 0.025)},
                            .k_over_m = k_over_m,
                            .dt = 0.1,
                            .gravity = {3, -9.81, 2},
                            .set = {"integrator.substeps=" + std::to_string(steps)}};
    Trial trial(b.method, scene_of(setup, b.method));
    trial.advance();
    return trial.simulation().state().x;
}

}  // namespace

// Of a swinging curl, over halvings of dt.
StabilityCase order_in_time(const Battery& b, double k_over_m) {
    const bool single = b.method.precision == "float";
    StabilityCase c = b.named("S6", "order in dt of a swinging curl", {{"k_over_m", k_over_m}});
    // Stiff strands need shorter steps to show an order; in single precision steps so short that only
    // rounding is left say nothing.
    const int coarse = b.method.fibre > 0 && !single              ? 800
                       : k_over_m <= 1e4 && !(b.method.fibre > 0) ? 200
                                                                  : 400,
              halvings = single ? 1 : 2;
    StabilityMethod fine = b.method;
    fine.precision = "double";
    const Points exact = swung({fine, b.options}, k_over_m, 64 * coarse);
    double before = 0, least = unbounded;
    for (int k = 0, steps = coarse; k <= halvings; ++k, steps *= 2) {
        const double error = rms_distance(swung(b, k_over_m, steps), exact);
        if (k > 0) {
            const double order = order_between(before, error);
            c.measured.emplace_back("order_at_" + std::to_string(steps) + "_steps", order);
            least = std::min(least, order);
        }
        before = error;
        c.finite = c.finite && std::isfinite(error);
    }
    c.measured.emplace_back("least_error_m", before);
    // 1.9 of 2 for BDF2; of fibres in single precision, whose steps cannot be shorter, a little less.
    const double share = b.method.fibre > 0 && single ? 0.92 : 0.95;
    c.passed = c.finite && least >= share * b.method.order;
    return c;
}

// Droop of a cantilever under its own small weight q a length: q L^4 / 8 EI. First order in the segment,
// since the clamped edge is one ((1 + 1/m)(1 + 1/(2m)) for a load at the tip).
StabilityCase order_in_particles(const Battery& b) {
    StabilityCase c = b.named("S6", "order in N of a drooping beam", {});
    const double reach = 0.1, flexural = 1e-9, g = 0.02;  // [m], [N m²], [m/s²]: a droop of 2 mm
    double before = 0, least = unbounded;
    for (int n : {10, 20, 40}) {
        const double l = reach / (n - 2), k = flexural / (l * l * l);
        const StrandSetup setup{.shapes = {straight_points(n, (n - 1) * l, {1, 0, 0})},
                                .k_over_m = 0,
                                .gravity = {0, -g, 0},
                                .drag = 9,
                                .set = {setting("bend.stiffness", k), setting("stretch.stiffness", 100 * k)}};
        Trial trial(b.method, scene_of(setup, b.method));
        trial.advance_for(5);
        const double tip = -trial.simulation().state().x.back().y;
        const double ratio = tip / (trial.scene().linear_density * g * std::pow(reach, 4) / (8 * flexural));
        const double error = std::abs(ratio - 1);
        c.measured.emplace_back("ratio_of_" + std::to_string(n), ratio);
        if (before > 0) least = std::min(least, order_between(before, error));
        before = error;
        c.finite = c.finite && std::isfinite(tip);
    }
    c.measured.emplace_back("order", least);
    c.rest_error = before;
    c.passed = c.finite && least >= 0.9;
    return c;
}

}  // namespace wetcurl::stability
