// Geometry images as pictures: a strand is a square of equal pixels, what holds no strand is hatched grey,
// and each picture says below it what it is.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "app/drawing/picture.h"

namespace wetcurl {

// Three numbers a pixel, shown as red, green and blue: value v as middle + gain v, clamped to 0..1.
struct GeometryPanel {
    int height = 0, width = 0;
    std::vector<float> values;         // (3, height, width)
    std::vector<uint8_t> mask;         // (height, width): 1 where it holds data
    float middle = 0, gain = 1;        // of all values alike
    std::vector<std::string> caption;  // lines under the picture

    size_t pixels() const { return size_t(height) * size_t(width); }
    // Colour (0..2) of a pixel that holds data.
    float colour(int channel, size_t pixel) const;
};

// The least side of a panel that is drawn unless another is asked for [pixels].
inline constexpr int least_panel = 400;

// How many pixels each way a pixel of `height` x `width` takes, so that the smaller side has at least
// `least`; fewer where the larger one would pass 8192.
int enlargement(int height, int width, int least);

// Grey of a pixel of the picture where there is no data: oblique stripes, which no data shows.
float neutral_grey(int column, int row);

// The image alone, each pixel `times` x `times`.
Image enlarged(const GeometryPanel& panel, int times);

// Without the rows and columns at its end that hold no data anywhere, but one of each, which shows that it
// goes on.
GeometryPanel without_padding(const GeometryPanel& panel);

// Panels side by side with their captions, without padding, each at least `least` pixels each way and all
// about as large. Throws Error without OpenCV, which draws the letters.
Image draw_geometry(const std::vector<GeometryPanel>& panels, int least);

}  // namespace wetcurl
