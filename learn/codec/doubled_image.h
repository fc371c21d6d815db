// An image at twice its size each way, what a network of codec root adds to: in plain numbers, for those that
// have no LibTorch. Eq 17; the same function as up() of models/layers.h.
#pragma once

#include <vector>

namespace wetcurl {

// (channels, height, width) to (channels, 2 height, 2 width): out[2i] = in[i], odd ones the mean of their
// neighbours, the last extrapolated from the two before it.
inline std::vector<float> doubled_image(const float* image, int channels, int height, int width) {
    const int rows = 2 * height, columns = 2 * width;
    std::vector<float> out(size_t(channels) * size_t(rows) * size_t(columns));
    // Element k of `count` ones twice as dense.
    auto between = [](auto at, int count, int k) {
        const int i = k / 2;
        if (k % 2 == 0) return float(at(i));
        const float beyond = i + 1 < count ? float(at(i + 1))
                             : count > 1   ? 2 * float(at(i)) - float(at(i - 1))
                                           : float(at(i));
        return 0.5f * (float(at(i)) + beyond);
    };
    for (int c = 0; c < channels; ++c)
        for (int row = 0; row < rows; ++row)
            for (int column = 0; column < columns; ++column)
                out[(size_t(c) * size_t(rows) + size_t(row)) * size_t(columns) + size_t(column)] = between(
                    [&](int r) {
                        const float* line = image + (size_t(c) * size_t(height) + size_t(r)) * size_t(width);
                        return between([&](int i) { return line[i]; }, width, column);
                    },
                    height, row);
    return out;
}

}  // namespace wetcurl
