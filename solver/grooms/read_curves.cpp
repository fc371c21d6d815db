// Strands from the curves of scene files.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "solver/grooms/readers.h"

namespace wetcurl {
namespace {

// A point of a curve: a weighted sum of control points, `first` and those that follow it.
struct Blend {
    size_t first;
    std::vector<double> weights;
};

// Weights of four control points at t in [0, 1] of their piece.
std::vector<double> cubic_weights(CurveBasis basis, double t) {
    const double s = 1 - t;
    switch (basis) {
        case CurveBasis::bezier:
            return {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
        case CurveBasis::b_spline:
            return {s * s * s / 6, (4 + t * t * (3 * t - 6)) / 6, (4 + s * s * (3 * s - 6)) / 6,
                    t * t * t / 6};
        case CurveBasis::catmull_rom:
            return {t * (-1 + t * (2 - t)) / 2, (2 + t * t * (3 * t - 5)) / 2, t * (1 + t * (4 - 3 * t)) / 2,
                    t * t * (t - 1) / 2};
        case CurveBasis::linear:
            break;
    }
    return {};
}

// Points of a curve of `count` control points, root first; `where` begins messages.
std::vector<Blend> points_of_curve(CurveBasis basis, size_t count, const std::string& where) {
    std::vector<Blend> out;
    if (basis == CurveBasis::linear || count < 2) {
        for (size_t i = 0; i < count; ++i) out.push_back({i, {1}});
        return out;
    }
    const size_t step = basis == CurveBasis::bezier ? 3 : 1;
    if (count < 4 || (count - 4) % step != 0)
        throw Error(where + ": found " + std::to_string(count) +
                    " control points of a cubic curve, allowed " +
                    (step == 3 ? "4, 7, 10 and so on for Bezier curves" : "4 or more"));
    constexpr int each = 4;  // points of a piece
    for (size_t first = 0; first + 4 <= count; first += step)
        for (int k = first == 0 ? 0 : 1; k <= each; ++k)
            out.push_back({first, cubic_weights(basis, double(k) / each)});
    return out;
}

}  // namespace

StrandFile read_curves(const std::string& path) {
    const auto scene = open_scene_file(path);
    const auto& objects = scene->curves();
    if (objects.empty())
        throw Error(path + ": found " +
                    (scene->meshes().empty()
                         ? std::string("no curves")
                         : std::to_string(scene->meshes().size()) + " meshes and no curves") +
                    ", allowed are strands as curves");
    StrandFile out;
    out.axes = scene->axes();
    // What only some objects say is said by none: the arrays would not fit the strands.
    auto all_say = [&](auto member) {
        return std::all_of(objects.begin(), objects.end(),
                           [&](const CurvesObject& o) { return o.counts.empty() || !(o.*member).empty(); });
    };
    const bool have_widths = all_say(&CurvesObject::widths), have_ids = all_say(&CurvesObject::ids),
               have_groups = all_say(&CurvesObject::groups), have_uv = all_say(&CurvesObject::root_uv);
    auto join = [](auto& to, const auto& from, bool have) {
        if (have) to.insert(to.end(), from.begin(), from.end());
    };
    for (size_t o = 0; o < objects.size(); ++o) {
        const CurvesObject& object = objects[o];
        const std::vector<Vec3f> points = scene->points_of_curves(o, 0);
        size_t begin = 0;
        for (size_t s = 0; s < object.counts.size(); ++s) {
            const auto blends = points_of_curve(object.basis, size_t(object.counts[s]),
                                                path + ": " + object.path + ", strand " + std::to_string(s));
            auto& strand = out.points.emplace_back();
            if (have_widths) out.widths.emplace_back();
            for (const auto& [first, weights] : blends) {
                Vec3d x{0, 0, 0};
                double width = 0;
                for (size_t k = 0; k < weights.size(); ++k) {
                    x += weights[k] * cast<double>(points[begin + first + k]);
                    if (have_widths) width += weights[k] * double(object.widths[begin + first + k]);
                }
                if (!(std::max({std::abs(x.x), std::abs(x.y), std::abs(x.z)}) < 1e6))
                    throw Error(path + ": " + object.path + ", strand " + std::to_string(s) + ", point " +
                                std::to_string(strand.size()) +
                                ": found a coordinate of 1e6 or more, allowed are smaller ones");
                strand.push_back(x);
                if (have_widths) out.widths.back().push_back(float(width));
            }
            begin += size_t(object.counts[s]);
        }
        join(out.ids, object.ids, have_ids);
        join(out.groups, object.groups, have_groups);
        join(out.root_uv, object.root_uv, have_uv);
    }
    return out;
}

}  // namespace wetcurl
