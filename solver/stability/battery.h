// The battery of stability, S1 to S10: what a way of stepping hair must stand, and figures for how it does.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "solver/run/simulation.h"

namespace wetcurl {

using Figures = std::vector<std::pair<std::string, double>>;

// A way of stepping. Most are named by settings of the scene alone: a compared method joins by a line.
struct StabilityMethod {
    std::string name, integrator;  // "ours", "implicit"; integrators of one name are judged together
    std::string precision;         // float | double
    // key.path=value over each case's scene; those of a term apply where the case names it.
    std::vector<std::string> settings;
    double order = 2;  // in dt, as the scheme states it
    // One frame; empty: Simulation::advance. Tests break it.
    std::function<void(Simulation&, const Scene&)> advance = {};
    // All that the terms add to forces and matrix; empty: `assemble` of each. Tests break it.
    std::function<void(const ChainTerms&, const ChainView<double>&, const ChainSystem<double>&)> assemble =
        {};
    // Tables of a scene: what draws wet strands together, and to solids.
    std::string cohesion = "[cohesion]\n", adhesion = "[adhesion]\n";
    // Which cases are its own: of dry strands, of wet ones beside each other, of wet ones at solids.
    bool dry = true, on_strands = true, on_solids = true;
    bool takes_drag = true;  // Eq 13, by which cases come to rest
    double fibre = 0;  // [m] diameter of the fibres that its strands are in the place of springs; 0: none
    // Of its own parameters, by key, of which it runs at the best; empty: as it is.
    std::vector<Figures> sweep = {};
    bool compared() const { return !sweep.empty(); }
};

// Ours in single and double precision, the paper's printed scheme, the compared methods: those of wet hair on
// our chain, so that it is their forces that fail, and on Iben's, as the paper runs them. Of a compared one
// the settings lack what `swept` finds.
const std::vector<StabilityMethod>& stability_methods();

// One case of the battery. NaN: not measured by this case.
struct StabilityCase {
    std::string id, what;  // "S5", "180 degree root jump"
    const StabilityMethod* method = nullptr;
    Figures parameters, measured;  // by name and unit
    bool finite = true, passed = false;
    double gain = NAN;          // S1: largest displacement over the noise
    double energy_ratio = NAN;  // (E - E0 - W) / max(K + |W|), the largest
    // S4: largest kinetic energy over what is allowed; S5, S9: at the end over m g L
    double kinetic_ratio = NAN;
    double rest_error = NAN;  // from the shape at rest, over the strand's length
};

// S2, S9, S10: what energy may rise by over max(K + |W|), and the jitter of still hair over a segment.
constexpr double energy_bound = 1e-3, jitter_bound = 1e-3;

struct StabilityOptions {
    bool quick = false;             // fewer values of each parameter, under a minute
    std::vector<std::string> only;  // cases by id; none: all
    std::string scene;              // of S9; "": one of our own
    std::vector<std::string> set;   // over that scene
};

// A group of cases that run one after the other; groups may run at once.
struct StabilityJob {
    std::string id;
    std::function<std::vector<StabilityCase>()> run;
};
// `method` must outlive the jobs.
std::vector<StabilityJob> stability_jobs(const StabilityMethod& method, const StabilityOptions& options);

// A compared method on a still wet head, at one value of its parameters.
struct SweepPoint {
    const StabilityMethod* method = nullptr;
    Figures at;
    bool finite = true;
    // What it does: 1 - the distance from tip to nearest tips, or from hair to head, over that without it.
    // NaN: it draws nothing.
    double effect = NAN;
    double jitter = NAN;        // rms third difference of frames, over a segment
    double energy_ratio = NAN;  // as of a case
    bool holds() const;         // still, and keeps its energy bounded
};
// Over all values, for a quick one every fourth on fewer strands; side by side. `method` must outlive the
// points.
std::vector<SweepPoint> swept(const StabilityMethod& method, const StabilityOptions& options);
// The strongest effect among those that hold; where none has an effect, or none holds, the least jitter.
const SweepPoint& best_of(const std::vector<SweepPoint>& points);
StabilityMethod method_at(const SweepPoint& point);

}  // namespace wetcurl
