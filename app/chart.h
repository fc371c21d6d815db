// Curves over time with axes, ticks and a legend, drawn into an image. Ours.
#pragma once

#include <string>
#include <vector>

#include "app/picture.h"

namespace wetcurl {

struct Curve {
    std::string name;
    Vec3f color;                 // as displayed
    std::vector<double> values;  // at k dx; one that is not finite ends the curve
    float width = 2;             // [pixel]
};

struct Chart {
    std::string title, x_label, y_label;  // with units
    double dx = 1;
    std::vector<Curve> curves;
};

// Steps of 1, 2 or 5 times a power of ten, at most `count` of them, from the first at or above `low` to
// `high`.
std::vector<double> ticks_between(double low, double high, int count);

// Charts of `width` x `height` pixels side by side, all on the same axes; the last bears the legend. Throws
// Error without OpenCV, which draws the letters.
Image draw_charts(const std::vector<Chart>& charts, int width, int height);

}  // namespace wetcurl
