// Strands from the curves of scene files.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/log.h"
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
    if (scene->curves().empty())
        throw Error(path + ": found " +
                    (scene->meshes().empty()
                         ? std::string("no curves")
                         : std::to_string(scene->meshes().size()) + " meshes and no curves") +
                    ", allowed are strands as curves");
    const std::vector<size_t> objects = chosen_objects(path, scene->curves(), "", "objects of curves");
    // Guides are strands that others follow: with these in the file, hair would be there twice.
    size_t strands = 0, guides = 0;
    for (size_t o : objects) {
        const CurvesObject& object = scene->curves()[o];
        strands += object.counts.size();
        guides +=
            object.is_guide.size() - size_t(std::count(object.is_guide.begin(), object.is_guide.end(), 0));
    }
    const bool leaves_guides = guides > 0 && guides < strands;
    if (leaves_guides)
        log_warning(path + ": " + std::to_string(guides) + " of " + std::to_string(strands) +
                    " strands left out, which the file marks as guides (groom_guide)");

    StrandFile out;
    out.axes = scene->axes();
    // What only some objects say is said by none: the arrays would not fit the strands.
    auto all_say = [&](auto member) {
        return std::all_of(objects.begin(), objects.end(), [&](size_t o) {
            const CurvesObject& object = scene->curves()[o];
            return object.counts.empty() || !(object.*member).empty();
        });
    };
    const bool have_widths = all_say(&CurvesObject::widths), have_ids = all_say(&CurvesObject::ids),
               have_groups = all_say(&CurvesObject::groups), have_uv = all_say(&CurvesObject::root_uv);
    for (size_t o : objects) {
        const CurvesObject& object = scene->curves()[o];
        const std::vector<Vec3f> points = scene->points_of_curves(o, 0);
        size_t begin = 0;
        for (size_t s = 0; s < object.counts.size(); begin += size_t(object.counts[s++])) {
            if (leaves_guides && !object.is_guide.empty() && object.is_guide[s]) continue;
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
            if (have_ids) out.ids.push_back(object.ids[s]);
            if (have_groups) out.groups.push_back(object.groups[s]);
            if (have_uv) out.root_uv.push_back(object.root_uv[s]);
        }
    }
    return out;
}

}  // namespace wetcurl
