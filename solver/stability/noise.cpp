// S1: noise on hair at rest, and on wet hair beside its neighbours, does not grow.
#include <algorithm>
#include <cmath>

#include "solver/stability/cases.h"

namespace wetcurl::stability {

namespace {

// [m]; in single 1e-6 of a segment would be below one ulp.
double noise_of(const Battery& b) {
    return (b.method.precision == "double" ? 1e-6 : 1e-3) * length / (particles - 1);
}

// Noise is put on the trial, which then goes on for `seconds` beside the positions without noise.
template <class Quiet>
void judge_noise(StabilityCase& c, const Battery& b, Trial& trial, double seconds, Quiet quiet) {
    const double noise = noise_of(b);
    SimulationState s = trial.simulation().state();
    add_noise(s, particles, noise, 4);
    trial.set(s);
    c.gain = 0;
    for (long k = std::lround(seconds * trial.scene().fps); k > 0 && trial.finite && c.gain < 1e6; --k) {
        trial.advance();
        c.gain = std::max(c.gain, farthest(trial.simulation().state().x, quiet()) / noise);
    }
    trial.report(c);
    c.passed = c.finite && c.gain <= 100;
}

}  // namespace

StabilityCase noise_at_rest(const Battery& b, double k_over_m, double dt) {
    StabilityCase c =
        b.named("S1", "noise at rest, straight and curly", {{"k_over_m", k_over_m}, {"dt", dt}});
    const StrandSetup setup{
        .shapes = {straight, curly}, .k_over_m = k_over_m, .dt = dt, .gravity = weightless};
    Trial trial(b.method, scene_of(setup, b.method));
    const auto rest = trial.simulation().state().x;
    judge_noise(c, b, trial, 10, [&] { return rest; });
    return c;
}

// Those that are drawn together come to rest first. Beside a copy without noise, since not all forces leave
// them a place to rest.
StabilityCase noise_beside_neighbours(const Battery& b, double k_over_m) {
    StabilityCase c =
        b.named("S1", "noise beside wet neighbours", {{"k_over_m", k_over_m}, {"dt", dt_usual}});
    StrandSetup free = wet_lock(b, k_over_m);
    free.gravity = weightless;
    StrandSetup settling = free;
    settling.drag = 20;
    Trial quiet(b.method, scene_of(settling, b.method)), noisy(b.method, scene_of(free, b.method));
    quiet.advance_for(6);
    quiet.go_on_in(scene_of(free, b.method));
    noisy.set(quiet.simulation().state());
    judge_noise(c, b, noisy, b.options.quick ? 2 : 10, [&] {
        quiet.advance();
        return quiet.simulation().state().x;
    });
    return c;
}

}  // namespace wetcurl::stability
