// Guesses of units.
#include "solver/grooms/guesses.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/geometry/file_frame.h"

namespace wetcurl {

namespace {

template <class... Values>
std::string text_of(const char* format, Values... values) {
    char text[160];
    std::snprintf(text, sizeof text, format, values...);
    return text;
}

double median(std::vector<double> numbers) {
    const auto middle = numbers.begin() + long(numbers.size() / 2);
    std::nth_element(numbers.begin(), middle, numbers.end());
    return *middle;
}

}  // namespace

Guess guessed_unit(const Mesh& mesh, const std::vector<Vec3d>& roots) {
    const Bounds box = bounding_box(mesh);
    const Vec3d size = box.high - box.low;
    const double longest = std::max({size.x, size.y, size.z});
    if (roots.empty()) {
        const char* word = longest < 0.02    ? ""
                           : longest <= 5    ? "m"
                           : longest <= 400  ? "cm"
                           : longest <= 4000 ? "mm"
                                             : "";
        if (!*word) return {};
        return {word, text_of("%.4g units across, %.3g m", longest, longest * metres_of(word))};
    }
    const MeshDistance surface(mesh);
    constexpr double near = 0.03;  // [m] of roots from a scalp, in the median
    for (const char* word : {"m", "cm", "mm"}) {
        const double metres = metres_of(word);
        std::vector<double> away;
        const size_t step = std::max<size_t>(1, roots.size() / 500);
        for (size_t k = 0; k < roots.size(); k += step)
            away.push_back(metres * surface.closest((1 / metres) * roots[k]).distance);
        const double typical = median(away);
        // A mesh that shrinks to a point lies no farther from the roots than these from the origin.
        if (typical < near && typical < 0.3 * longest * metres)
            return {word, text_of("%.4g units across, %.3g m; roots lie %.1f mm from it in the median",
                                  longest, longest * metres, 1000 * typical)};
    }
    return {};
}

}  // namespace wetcurl
