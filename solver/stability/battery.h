// The battery of stability, S1 to S9: what a way of stepping hair must stand, and figures for how it does.
// EQUATIONS Sec. 8. Ours.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "solver/simulation.h"

namespace wetcurl {

// A way of stepping. Most are named by settings of the scene alone: a compared method joins by a line.
struct StabilityMethod {
    std::string name, integrator;  // "ours", "implicit"; integrators of one name are judged together
    std::string precision;         // float | double
    // key.path=value over each case's scene; those of a term apply where the case names it.
    std::vector<std::string> settings;
    double order = 2;  // in dt, as the scheme states it
    // One frame; empty: Simulation::advance. Tests break it.
    std::function<void(Simulation&, const Scene&)> advance;
    // All that the terms add to forces and matrix; empty: `assemble` of each. Tests break it.
    std::function<void(const ChainTerms&, const ChainView<double>&, const ChainSystem<double>&)> assemble;
};

// Ours in single and double precision, the paper's printed scheme.
const std::vector<StabilityMethod>& stability_methods();

using Figures = std::vector<std::pair<std::string, double>>;

// One case of the battery. NaN: not measured by this case.
struct StabilityCase {
    std::string id, what;  // "S5", "180 degree root jump"
    const StabilityMethod* method = nullptr;
    Figures parameters, measured;  // by name and unit
    bool finite = true, passed = false;
    double gain = NAN;          // S1: largest displacement over the noise
    double energy_ratio = NAN;  // (E - E0 - W) / max(K + |W|), the largest
    double kinetic_ratio =
        NAN;  // S4: largest kinetic energy over what is allowed; S5, S9: at the end over m g L
    double rest_error = NAN;  // from the shape at rest, over the strand's length
};

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

}  // namespace wetcurl
