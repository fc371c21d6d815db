// Guesses of units and axes.
#include "solver/grooms/guesses.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/geometry/file_frame.h"
#include "base/median.h"
#include "solver/grooms/root_grid.h"

namespace wetcurl {

namespace {

template <class... Values>
std::string text_of(const char* format, Values... values) {
    char text[160];
    std::snprintf(text, sizeof text, format, values...);
    return text;
}

}  // namespace

Guess guessed_unit(const Mesh& mesh) {
    const Bounds box = bounding_box(mesh);
    const Vec3d size = box.high - box.low;
    const double longest = std::max({size.x, size.y, size.z});
    const char* word = longest < 0.02    ? ""
                       : longest <= 5    ? "m"
                       : longest <= 400  ? "cm"
                       : longest <= 4000 ? "mm"
                                         : "";
    if (!*word) return {};
    return {word, text_of("%.4g units across, %.3g m", longest, longest * metres_of(word))};
}

Guess guessed_unit(const Mesh& mesh, const std::vector<Vec3d>& roots, const std::vector<std::string>& units) {
    const Bounds box = bounding_box(mesh);
    const double across = norm(box.high - box.low);
    const MeshDistance surface(mesh);
    constexpr double near = 0.03;  // [m] of roots from a scalp, in the median
    for (const std::string& word : units) {
        const double metres = metres_of(word);
        std::vector<double> away;
        const size_t step = std::max<size_t>(1, roots.size() / 500);
        for (size_t k = 0; k < roots.size(); k += step)
            away.push_back(metres * surface.closest((1 / metres) * roots[k]).distance);
        const double typical = median(away);
        // A mesh that shrinks to a point lies no farther from the roots than these from the origin.
        if (typical < near && typical < 0.2 * across * metres)
            return {word,
                    text_of("%.4g units across, %.3g m; roots lie %.1f mm from it in the median", across,
                            across * metres, 1000 * typical),
                    typical};
    }
    return {};
}

Guess guessed_up(const StrandPoints& strands) {
    std::vector<Vec3d> roots;
    Vec3d fall{0, 0, 0}, middle{0, 0, 0};
    double sum = 0;
    for (const auto& strand : strands) {
        if (strand.size() < 2) continue;
        const Vec3d way = strand.back() - strand.front();
        roots.push_back(strand.front());
        fall += way, sum += norm(way), middle += strand.front();
    }
    if (roots.size() < 8 || !(sum > 0)) return {"y", ""};
    const RootDome dome = dome_of(roots);
    if (dome.flat || !(dome.radius > 0)) return {"y", ""};
    const Vec3d falls = (1 / sum) * fall,
                lie = (1 / dome.radius) * ((1 / double(roots.size())) * middle - dome.centre);
    const auto upward = [](const char* up, const Vec3d& x) { return upright(up, x).y; };
    // Hair that is combed back falls along z, but its roots do not lie so.
    constexpr double clearly = 0.3, ahead_of_y = 0.5;
    const auto both = [&](const char* up) { return upward(up, lie) - upward(up, falls); };
    for (const char* up : {"z", "-z", "x", "-x"})
        if (upward(up, falls) < -clearly && upward(up, lie) > clearly && both(up) > both("y") + ahead_of_y)
            return {up,
                    text_of("hair falls along (%.1f, %.1f, %.1f) and its roots lie toward (%.1f, %.1f, %.1f)",
                            falls.x, falls.y, falls.z, lie.x, lie.y, lie.z)};
    return {"y", ""};
}

}  // namespace wetcurl
