// Curves, scatters and bars with axes, ticks and a legend, drawn into an image.
#pragma once

#include <string>
#include <vector>

#include "app/drawing/picture.h"

namespace wetcurl {

struct Curve {
    std::string name;            // "": not in the legend
    Vec3f color;                 // as displayed
    std::vector<double> values;  // at k dx, or at x; one that cannot be drawn is a gap
    float width = 2;             // [pixel]
    std::vector<double> x = {};  // of the values; empty: k dx
    bool dashed = false;
};

// Many points: the more of them in a place, the deeper its colour.
struct Scatter {
    std::string name;
    Vec3f color;
    std::vector<double> x, y;
};

// A bar from 0, its name at the vertical axis.
struct Bar {
    std::string name;
    double value;
    Vec3f color;
};

struct Chart {
    std::string title, x_label, y_label;  // with units
    double dx = 1;
    std::vector<Curve> curves;
    bool logarithmic = false;  // the vertical axis; what is not above 0 is not drawn there
    bool own_axes = false;     // not those of the charts beside it
    bool own_legend = false;   // else the last chart bears that of all
    std::vector<Scatter> scatters = {};
    std::vector<Bar> bars = {};  // from top to bottom, alone in their chart, which has own axes
};

// Steps of 1, 2 or 5 times a power of ten, at most `count` of them, from the first at or above `low` to
// `high`.
std::vector<double> ticks_between(double low, double high, int count);
// 1, 2, 5 of each decade from `low` to `high`, both above 0; of more than three decades 1 alone.
std::vector<double> log_ticks_between(double low, double high);
// 1, 2 or 5 times a power of ten, at or above x; of less than 0.001 that.
double round_above(double x);

// Charts of `width` x `height` pixels, and legends, side by side, those without own axes all on the same.
// Throws Error without OpenCV, which draws the letters.
Image draw_charts(const std::vector<Chart>& charts, int width, int height);

}  // namespace wetcurl
