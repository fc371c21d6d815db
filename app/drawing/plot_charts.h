// The charts that `plot` draws.
#pragma once

#include <memory>
#include <vector>

#include "app/drawing/chart.h"
#include "app/files/training_log.h"
#include "base/run_cache.h"
#include "learn/codec/network.h"
#include "learn/codec/pairs.h"

namespace wetcurl {

// (frame) [mJ] of each kind that a run ever has, and their sum. Gravity counts from the first frame: no
// height is nought by itself. Throws Error where the run has none.
Chart energy_chart(const RunReader& run);

// (frame) [ms] of the stages that take longest in any of the runs, of all others together, and of the whole
// frame; a chart a run, the median of each curve in its name. Logarithmic where medians differ by more than
// ten. A frame that took no time, as the first, is a gap. Throws Error where a run has no times.
std::vector<Chart> time_charts(const std::vector<std::unique_ptr<RunReader>>& runs);

// On axes of its own, logarithmic.
Chart training_chart(const TrainingLog& log);

// Of an adhesion network on the samples of all runs of a pairs file: its answers against the targets; over
// phi/h, beside Eq 11; and how far each input moves them: root mean square of what changes where that input
// is its mean. Throws Error where pairs and network do not fit.
std::vector<Chart> adhesion_charts(const PairsReader& pairs, Network& network, const std::string& model);

}  // namespace wetcurl
