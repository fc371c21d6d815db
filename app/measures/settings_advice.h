// What substeps, precision and the settings of Eq 10 cost and gain in a scene, as scripts/settings measured
// it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "solver/scene/scene.h"

namespace wetcurl {

struct SettingsAdvice {
    struct Row {
        std::string setting;
        // Median over displayed particles and frames of the distance from 80 substeps in double precision
        // with all of Eq 10 computed, in percent of a strand's length.
        double error;
        double time;  // of a frame, over that of the scene as it is
    };
    std::string hair, kind, machine;  // on which it was measured: of kinds, dry | wet | touching
    std::vector<Row> rows;            // the scene as it is, and what it might say in place of one setting
    std::vector<std::string> advice;  // which of them is better, or dearer for nothing
};

// From the measured hair whose curls are curved most like the scene's. None where no such scene was measured:
// an explicit integrator, a compared method, contact without water, water without Eq 10, cohesion in the
// solve.
std::optional<SettingsAdvice> advice_on(const Scene& scene);

}  // namespace wetcurl
