// S2: the energy rises by no more than is given. S8: what the limiter gives.
#include <algorithm>

#include "solver/stability/cases.h"

namespace wetcurl::stability {

namespace {

void judge_energy(StabilityCase& c, const Trial& trial) {
    trial.report(c);
    c.passed = c.finite && c.energy_ratio <= energy_bound;
}

StabilityCase energy_of(const Battery& b, const std::string& what, StrandSetup setup, double angle,
                        double seconds) {
    StabilityCase c =
        b.named("S2", what, {{"k_over_m", setup.k_over_m}, {"dt", setup.dt}, {"limiter", setup.limiter}});
    Trial trial(b.method, scene_of(setup, b.method));
    if (angle > 0) {
        SimulationState s = trial.simulation().state();
        sway(s, particles, angle);
        trial.set(s);
    }
    trial.advance_for(seconds);
    judge_energy(c, trial);
    return c;
}

const char* const shaken = "[motion]\nangle = 40\naxis = [0, 0, 1]\nshift = [0.02, 0.03, 0]\nperiod = 0.5\n";
const char* const still_ball =
    "[[solid]]\nradius = 0.05\nfriction = 0\n[[solid.motion.keyframe]]\ntranslation = [0.0, -0.25, 0.02]\n";
const char* const moving_ball =
    "[[solid]]\nradius = 0.05\n[[solid.motion.keyframe]]\ntime = 0.1\ntranslation = [0.2, -0.2, 0.01]\n"
    "[[solid.motion.keyframe]]\ntime = 1.1\ntranslation = [-0.2, -0.2, 0.01]\n";

StabilityCase energy_of_wetting(const Battery& b, double k_over_m) {
    StabilityCase c =
        b.named("S2", "wetted and dried in a swing", {{"k_over_m", k_over_m}, {"dt", dt_usual}});
    StrandSetup dry{.shapes = {straight, curly}, .k_over_m = k_over_m}, wet = dry;
    wet.more = "[wetness]\nabsorbed = 1\n";
    Trial trial(b.method, scene_of(dry, b.method));
    SimulationState s = trial.simulation().state();
    sway(s, particles, 0.5);
    trial.set(s);
    for (const auto* next : {&wet, &dry, &wet}) {
        trial.advance_for(0.3);
        trial.go_on_in(scene_of(*next, b.method));
    }
    trial.advance_for(0.5);
    judge_energy(c, trial);
    return c;
}

}  // namespace

Cases energies_of(const Battery& b, double k_over_m) {
    Cases out;
    const double seconds = b.options.quick ? 1 : 4;
    for (double limiter : {0.0, 0.1}) {
        const StrandSetup free{
            .shapes = {straight, curly}, .k_over_m = k_over_m, .limiter = limiter, .gravity = weightless};
        StrandSetup hanging = free;
        hanging.gravity = down;
        out.push_back(energy_of(b, "small sway", free, 0.03, seconds));
        out.push_back(energy_of(b, "large sway", free, 1.5, seconds));
        out.push_back(energy_of(b, "fall", hanging, 0, seconds));
        hanging.more = shaken;
        out.push_back(energy_of(b, "shaken root", hanging, 0, seconds));
        hanging.more = still_ball;
        out.push_back(energy_of(b, "swing against a still ball", hanging, 1.0, seconds));
        hanging.more = moving_ball;
        out.push_back(energy_of(b, "swept by a ball", hanging, 0, seconds));
    }
    out.push_back(energy_of_wetting(b, k_over_m));
    return out;
}

// What draws wet strands is either an energy that is kept, and counted, or gives nothing.
Cases energies_of_wet(const Battery& b, double k_over_m) {
    Cases out;
    const double seconds = b.options.quick ? 1 : 4;
    if (b.method.on_strands) {
        StrandSetup lock = wet_lock(b, k_over_m);
        out.push_back(energy_of(b, "wet lock released", lock, 0, seconds));
        out.push_back(energy_of(b, "wet lock in a large sway", lock, 1.5, seconds));
        lock.more += shaken;
        out.push_back(energy_of(b, "wet lock, shaken root", lock, 0, seconds));
    }
    if (b.method.on_solids)
        for (const char* ball : {still_ball, moving_ball}) {
            const StrandSetup at{.shapes = {straight, curly},
                                 .k_over_m = k_over_m,
                                 .more = "[wetness]\n" + b.method.adhesion + ball};
            const bool still = ball == still_ball;
            out.push_back(energy_of(b, still ? "wet, swing against a still ball" : "wet, swept by a ball", at,
                                    still ? 1.0 : 0.0, seconds));
        }
    return out;
}

StabilityCase limiter_honesty(const Battery& b, double k_over_m) {
    StabilityCase c = b.named("S8", "work of the limiter", {{"k_over_m", k_over_m}, {"limiter", 0.1}});
    const StrandSetup setup{.shapes = {straight, curly}, .k_over_m = k_over_m, .limiter = 0.1};
    Trial trial(b.method, scene_of(setup, b.method));
    double before = 0, most = 0, least = 0;
    for (int f = 0; f < 480 && trial.finite; ++f) {
        trial.advance();
        const double sum = trial.simulation().work().limiter;
        most = std::max(most, sum - before), least = std::min(least, sum - before);
        before = sum;
    }
    trial.report(c);
    const double weight = trial.weight_length();
    c.measured.emplace_back("sum_over_weight", before / weight);
    c.measured.emplace_back("most_in_a_frame_over_weight", most / weight);
    c.measured.emplace_back("least_in_a_frame_over_weight", least / weight);
    c.measured.emplace_back("limited_edges", double(trial.simulation().limited_edges()));
    // It may take energy; what it gives, S2 must not notice.
    c.passed = c.finite && before <= energy_bound * std::max(trial.scale, 1e-9 * weight);
    return c;
}

}  // namespace wetcurl::stability
