// Charts of a report as inline SVG; colours and marks are the page's classes learned, interpolated,
// simulated.
#pragma once

#include <string>
#include <vector>

#include "app/files/training_log.h"
#include "app/report/report_rows.h"

namespace wetcurl {

// Error against run time, both on logarithmic axes: a labelled mark for each row, the front as a staircase,
// the range of seeds as a stroke, the time of the references themselves as a line. Rows of other scenes than
// most are hollow. An error below best_cost's (app/measures/pareto_front.h) stands at that.
std::string cost_chart(const Rows& rows);

struct ErrorCurve {
    std::string name, kind;
    std::vector<double> mm;  // (compared frame)
};

// Error over the time of a run. x of value k: start + k step, in the unit that `x_label` names.
std::string error_chart(const std::vector<ErrorCurve>& curves, double start, double step,
                        const std::string& x_label);

// What is learned over the epochs, on a logarithmic axis: training, held out, no network.
std::string training_chart_svg(const TrainingLog& log);

// Moves `places`, sorted or not, apart to at least `gap` each, within low..high as far as they fit, in their
// order and near where they were: heights of labels.
std::vector<double> spread_apart(const std::vector<double>& places, double gap, double low, double high);

}  // namespace wetcurl
