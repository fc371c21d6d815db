// Compared methods over decades of their own parameters, on a still wet head.
#include <algorithm>
#include <cmath>

#include "solver/stability/trial.h"

namespace wetcurl {

namespace {

// Strands 7 mm apart at the roots, within reach of each other. The springs are the defaults.
const std::string still_head = R"([groom]
grid = [8, 8]
particles = 50
coverage = 0.4
[stretch]
[bend]
[core]
[wetness]
)";
// For those alone that act on it: contact trembles by itself.
const std::string head = "[[solid]]\nname = \"head\"\nradius = 0.095\nattached = \"head\"\n";
const std::string implicit_steps = "[integrator]\nsubsteps = 10\n[stiffness]\nglobal = 10\n";
// Soft, well damped springs and short steps, which explicit ones carry: scenes/compare_iben.toml.
const std::vector<std::string> for_explicit_steps{
    "integrator.substeps=400", "stretch.stiffness=0.5", "stretch.damping=1e-4", "bend.stiffness=0.005",
    "bend.damping=2e-4",       "core.stiffness=0.002",  "core.damping=2e-5"};

// Mean distance from each tip to the four nearest [m].
double tip_spread(const Strands& p) {
    double sum = 0;
    for (int s = 0; s < p.count; ++s) {
        std::vector<float> distances;
        for (int other = 0; other < p.count; ++other)
            distances.push_back(norm(p.at(other, p.particles - 1) - p.at(s, p.particles - 1)));
        std::nth_element(distances.begin(), distances.begin() + 4, distances.end());
        for (int k = 0; k <= 4; ++k) sum += distances[size_t(k)];  // the nearest is itself, at 0
    }
    return sum / (4.0 * p.count);
}
// Mean distance of the particles from the head's surface [m].
double distance_from_head(const Scene& scene, const Strands& p) {
    double sum = 0;
    for (const auto& x : p.points) sum += norm(x);
    return sum / double(p.points.size()) - std::get<Sphere>(scene.solids.front().shape).radius;
}

Trial settled(const StabilityMethod& method, const StabilityOptions& options) {
    std::vector<std::string> set;
    std::string text = still_head;
    if (method.takes_drag)
        text += implicit_steps;
    else
        set = for_explicit_steps;
    if (method.on_strands) text += method.cohesion;
    if (method.on_solids) text += head + method.adhesion;
    if (options.quick) set.insert(set.end(), {"groom.grid=[5, 5]", "groom.coverage=0.25"});
    Trial trial(method, scene_of(text, "sweep", ".", set, method));
    // Pairs of strands in explicit steps take minutes, and their springs are well damped.
    trial.advance_for(method.on_strands && !method.takes_drag ? 1 : 4);
    return trial;
}

double reach(const StabilityMethod& method, Trial& trial) {
    RunFrame frame;
    trial.simulation().snapshot(frame);
    return method.on_solids ? distance_from_head(trial.scene(), frame.seen()) : tip_spread(frame.seen());
}

}  // namespace

bool SweepPoint::holds() const { return finite && jitter <= jitter_bound && energy_ratio <= energy_bound; }

StabilityMethod method_at(const SweepPoint& point) {
    StabilityMethod m = *point.method;
    for (const auto& [key, value] : point.at) m.settings.push_back(setting("baseline." + key, value));
    return m;
}

std::vector<SweepPoint> swept(const StabilityMethod& method, const StabilityOptions& options) {
    std::vector<SweepPoint> points;
    for (size_t k = 0; k < method.sweep.size(); k += options.quick ? 4 : 1)
        points.push_back({.method = &method, .at = method.sweep[k]});
    double without = NAN;
    if (method.on_strands || method.on_solids) {
        SweepPoint none = points.front();
        for (auto& [key, value] : none.at) value = 0;
        const StabilityMethod idle = method_at(none);
        Trial trial = settled(idle, options);
        without = reach(method, trial);
    }
#pragma omp parallel for schedule(dynamic)
    for (auto& point : points) {
        const StabilityMethod with = method_at(point);
        Trial trial = settled(with, options);
        point.jitter = jitter_of(trial);
        point.finite = trial.finite, point.energy_ratio = trial.energy_ratio();
        point.effect = 1 - reach(method, trial) / without;
    }
    return points;
}

const SweepPoint& best_of(const std::vector<SweepPoint>& points) {
    return *std::max_element(points.begin(), points.end(), [](const SweepPoint& a, const SweepPoint& b) {
        if (a.holds() != b.holds()) return b.holds();
        return a.holds() && a.effect != b.effect && !std::isnan(a.effect) ? a.effect < b.effect
                                                                          : b.jitter < a.jitter;
    });
}

}  // namespace wetcurl
