// Comparisons with a reference, made and written as JSON: what `compare` and `report` share.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/files/results.h"
#include "app/measures/metrics.h"

namespace wetcurl {

// What `compare --json` says of one run: an entry of its `others`.
Json json_of(const Comparison& comparison);

// The reference's time a frame over the run's, over the frames that are compared; none where either has no
// time.
std::optional<double> speed_up(const Comparison& comparison);

// Each of `others` against `reference`, frames from `first_frame` on, solids as the reference's scene has
// them. Warns of runs of another length. Throws Error as `compare` does (app/measures/metrics.h).
std::vector<Comparison> compare_runs(const std::string& reference, const std::vector<std::string>& others,
                                     int first_frame);

}  // namespace wetcurl
