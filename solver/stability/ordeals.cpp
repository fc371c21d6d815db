// S5: jolts, degenerate shapes and scenes that change at once, and hair at rest after them.
#include <algorithm>
#include <cmath>

#include "solver/stability/cases.h"

namespace wetcurl::stability {

namespace {

// Scenes one after the other, then rest.
struct Ordeal {
    std::string what;
    std::vector<StrandSetup> scenes;
    std::vector<double> seconds;
    std::function<void(SimulationState&)> disturb;  // at the start; may be empty
    // The first frame is the ordeal: a solid throws out what was drawn into it, and that bends the strand.
    bool after_first_frame = false;
};

// Stated, with no scheme in mind: what an ordeal may leave unaccounted for is less than what it put in.
constexpr double ordeal_bound = 1, settled_bound = 1e-4;

StabilityCase stood(const Battery& b, const Ordeal& o) {
    const StrandSetup& first = o.scenes.front();
    StabilityCase c =
        b.named("S5", o.what, {{"k_over_m", first.k_over_m}, {"dt", first.dt}, {"limiter", first.limiter}});
    Trial trial(b.method, scene_of(first, b.method));
    if (o.disturb) {
        SimulationState s = trial.simulation().state();
        o.disturb(s);
        trial.set(s);
    }
    if (o.after_first_frame) {
        trial.advance();
        trial.set(trial.simulation().state());
    }
    for (size_t k = 0; k < o.scenes.size(); ++k) {
        if (k > 0) trial.go_on_in(scene_of(o.scenes[k], b.method));
        trial.advance_for(o.seconds[k]);
    }
    trial.report(c);
    c.kinetic_ratio = trial.finite ? trial.kinetic / trial.weight_length() : unbounded;
    c.measured.emplace_back("most_kinetic_over_weight", trial.most_kinetic / trial.weight_length());
    c.passed = c.finite && c.energy_ratio <= ordeal_bound &&
               (!b.method.takes_drag || c.kinetic_ratio <= settled_bound);
    return c;
}

// Until a swing [rad/s] with critical drag has settled [s].
double settling_time(double swing) { return std::max(12 / swing, 3.0); }

const char* const turned_root =
    "[motion]\n[[motion.keyframe]]\ntime = 0.1\n[[motion.keyframe]]\ntime = 0.141667\nrotation = "
    "[0, 180, 0]\n";
const char* const pierced =
    "[[solid]]\nradius = 0.05\n[[solid.motion.keyframe]]\ntranslation = [0.01, -0.22, 0.0]\n";

Cases all_of(const Battery& b, const std::vector<Ordeal>& ordeals) {
    Cases out;
    for (const auto& o : ordeals) out.push_back(stood(b, o));
    return out;
}

}  // namespace

Cases ordeals(const Battery& b, double k_over_m, double limiter) {
    const double swing = slowest_swing(b, k_over_m), settle = settling_time(swing);
    const StrandSetup base{
        .shapes = {straight, curly}, .k_over_m = k_over_m, .limiter = limiter, .drag = critical_drag(swing)};
    std::vector<Ordeal> all;
    auto add = [&](const std::string& what, auto change, std::function<void(SimulationState&)> disturb = {}) {
        StrandSetup setup = base;
        change(setup);
        all.push_back({what, {setup}, {settle}, disturb});
    };
    add("root turned by 180 degrees in a frame", [](StrandSetup& s) { s.more = turned_root; });
    add("10 g", [](StrandSetup& s) { s.gravity = 10 * down; });
    add(
        "zero-length edge", [](StrandSetup&) {},
        [](SimulationState& s) {
            s.x[10] = s.x[9];
            carry_frames(s, particles);
        });
    add("tip inside a solid", [](StrandSetup& s) { s.more = pierced; });
    all.back().after_first_frame = true;
    add("two particles", [](StrandSetup& s) {
        s.shapes = {straight_points(2, 0.01, {0, -1, 0}), straight_points(2, 0.01, {1, 0, 0})};
    });
    // The same fibre of more particles: k goes with their number, m against it.
    const auto refine = [](StrandSetup& s, int n) { s.k_over_m *= std::pow(double(n) / particles, 2); };
    add("curl radius of 2 mm", [&](StrandSetup& s) {
        s.shapes = {helix_points(200, length, 0.002, 0.005)};
        refine(s, 200);
    });
    StrandSetup wet = base;
    wet.more = "[wetness]\nabsorbed = 1\n[curl]\n";
    all.push_back({"dry, wet and dry in a step", {base, wet, base}, {0.5, 0.5, settle}, {}});
    // Segments a thousand times shorter above long ones, wet at the tip: masses from 1 to 1e4.
    const double heavy = slowest_swing(b, k_over_m / 22);  // a tip's particle: 22 times the mean
    add("mass ratio of 1e4", [&](StrandSetup& s) {
        Points p = straight_points(particles / 2, 2.4e-4 * length, {0, -1, 0});
        while (p.size() < size_t(particles)) p.push_back(p.back() + Vec3d{0, -0.01, 0});
        s.shapes = {p};
        s.more = "[wetness]\nabsorbed = 10\npattern = \"tip\"\n";
        s.drag = critical_drag(heavy);
    });
    all.back().seconds = {settling_time(heavy)};
    StrandSetup coarse = base, fine = base;
    coarse.dt = 1.0 / 24, fine.dt = coarse.dt / 100;
    all.push_back(
        {"step a hundred times longer in a swing", {fine, coarse}, {0.3, settle}, [](SimulationState& s) {
             sway(s, particles, 0.5);
         }});
    if (!b.options.quick && limiter == 0)
        add("10,000 particles", [&](StrandSetup& s) {
            s.shapes = {straight_points(10000, length, {0, -1, 0})};
            refine(s, 10000);
        });
    return all_of(b, all);
}

Cases wet_ordeals(const Battery& b, double k_over_m) {
    const double swing = slowest_swing(b, k_over_m);
    std::vector<Ordeal> all;
    auto add = [&](const std::string& what, StrandSetup setup, const std::string& more = "") {
        setup.drag = critical_drag(swing), setup.more += more;
        all.push_back({what, {setup}, {settling_time(swing)}, {}});
    };
    const StrandSetup lock = wet_lock(b, k_over_m);
    if (b.method.on_strands) {
        StrandSetup heavy = lock, together = lock;
        heavy.gravity = 10 * down;
        for (auto& shape : together.shapes) shape = curly;
        add("wet lock, root turned by 180 degrees in a frame", lock, turned_root);
        add("wet lock at 10 g", heavy);
        add("coincident strands", together);
        add("wet lock, step a hundred times longer in a swing", lock);
        Ordeal& longer = all.back();
        longer.scenes.front().dt = 1.0 / 24,
        longer.scenes.insert(longer.scenes.begin(), longer.scenes.front());
        longer.scenes.front().dt /= 100, longer.seconds.insert(longer.seconds.begin(), 0.3);
        longer.disturb = [](SimulationState& s) { sway(s, particles, 0.5); };
    }
    if (b.method.on_solids) {
        StrandSetup at = lock;
        at.shapes = {straight, curly}, at.more = "[wetness]\n" + b.method.adhesion;
        add("wet, tip inside a solid", at, pierced);
        all.back().after_first_frame = true;
    }
    return all_of(b, all);
}

}  // namespace wetcurl::stability
