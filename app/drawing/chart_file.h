// Charts from a JSON file, for what a script has measured.
#pragma once

#include <string>

#include "app/drawing/chart.h"

namespace wetcurl {

// {"title", "x_label", "y_label", "dx", "curves": [{"name", "values": [number or null, ...]}, ...]}; null is
// a gap. Throws Error where the file is something else, or holds no curve of two values.
Chart chart_of_file(const std::string& path);

}  // namespace wetcurl
