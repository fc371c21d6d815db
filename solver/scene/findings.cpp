// Sanity of scenes.
#include "solver/scene/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/log.h"

namespace wetcurl {

using Level = Finding::Level;

namespace {

double middle(std::vector<double> numbers) {
    if (numbers.empty()) return 0;
    std::nth_element(numbers.begin(), numbers.begin() + long(numbers.size() / 2), numbers.end());
    return numbers[numbers.size() / 2];
}

std::string in_millimetres(double metres) { return fmt::format("{:.3g} mm", 1e3 * metres); }

struct AttachedSolids {
    const Scene& scene;
    bool any() const {
        return std::any_of(scene.solids.begin(), scene.solids.end(),
                           [](const Solid& s) { return s.attached && !s.deformation; });
    }
    // Signed [m], in the head's frame at rest.
    double distance_to(const Vec3d& x) const {
        double nearest = 1e300;
        for (const auto& solid : scene.solids)
            if (solid.attached && !solid.deformation)
                nearest = std::min(nearest, double(distance(solid.shape, x).phi));
        return nearest;
    }
    // Diagonal of the largest one [m]; 0 where one has no end.
    double size() const {
        double largest = 0;
        for (const auto& solid : scene.solids)
            if (solid.attached && !solid.deformation) {
                const Bounds box = bounds_of(solid.shape);
                const double diagonal = norm(box.high - box.low);
                if (!std::isfinite(diagonal)) return 0;
                largest = std::max(largest, diagonal);
            }
        return largest;
    }
};

void find_roots(std::vector<Finding>& out, const Scene& scene) {
    const AttachedSolids head{scene};
    if (!head.any()) return;
    const auto& hair = scene.groom.rest;
    std::vector<double> away, deep;
    size_t nearer_tips = 0;
    Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    for (int s = 0; s < hair.count; ++s) {
        const Vec3d root = cast<double>(hair.at(s, 0)), tip = cast<double>(hair.at(s, hair.particles - 1));
        const double phi = head.distance_to(root);
        constexpr double clearly = 0.02;  // [m]
        nearer_tips += std::abs(head.distance_to(tip)) + clearly < std::abs(phi);
        away.push_back(std::abs(phi));
        if (phi < 0) deep.push_back(-phi);
        for (const Vec3d& x : {root, tip}) low = lower(low, x), high = upper(high, x);
    }
    const double median = middle(away), most = *std::max_element(away.begin(), away.end());
    const std::string place =
        fmt::format("roots lie {} from the head in the median, {} at most; {} of {} below its surface",
                    in_millimetres(median), in_millimetres(most), deep.size(), hair.count);
    const bool tips_first = double(nearer_tips) > 0.5 * hair.count;
    if (tips_first)
        out.push_back(
            {Level::error, "order",
             fmt::format("{} of {} strands end nearer to the head than they begin", nearer_tips, hair.count),
             "order = \"tip_first\" in [groom], if the file's strands run from tip to root"});
    constexpr double far = 0.03, too_far = 0.3;  // [m]
    if (median > too_far)
        out.push_back({Level::error, "roots_off_head", place,
                       "units, up, scale and offset of [groom] or of the [[solid]] that is the head"});
    else if (median > far && !tips_first)
        out.push_back({Level::warning, "roots_off_head", place,
                       "units, up, scale and offset of [groom] or of the [[solid]] that is the head"});
    else
        out.push_back({Level::note, "roots_off_head", place, ""});
    const double across = norm(high - low), size = head.size();
    constexpr double ratio = 12;
    if (size > ratio * across || (size > 0 && size * ratio < across))
        out.push_back({median > too_far || size > ratio * across ? Level::error : Level::warning, "head_size",
                       fmt::format("the head is {:.3g} m across, the hair {:.3g} m", size, across),
                       "units of the [[solid]] that is the head"});
}

void find_meshes(std::vector<Finding>& out, const Scene& scene) {
    for (const auto& solid : scene.solids) {
        const auto* level_set = std::get_if<std::shared_ptr<const LevelSet>>(&solid.shape);
        if (!level_set || !*level_set) continue;
        const Mesh& mesh = (*level_set)->mesh();
        if (const int open = boundary_edges(mesh))
            out.push_back(
                {Level::note, "open_mesh",
                 fmt::format(
                     "{}: the mesh has {} open edges; what is inside is told by the winding of its faces",
                     solid.name, open),
                 ""});
        std::set<std::array<int, 3>> seen;
        size_t doubled = 0;
        for (auto corners : mesh.triangles) {
            std::sort(corners.begin(), corners.end());
            doubled += !seen.insert(corners).second;
        }
        if (doubled)
            out.push_back({Level::warning, "doubled_faces",
                           fmt::format("{}: {} of {} faces are there twice", solid.name, doubled,
                                       mesh.triangles.size()),
                           ""});
    }
}

void find_water(std::vector<Finding>& out, const Scene& scene) {
    if (!scene.wetness || scene.flow || scene.saturation.empty()) return;
    if (std::all_of(scene.saturation.begin(), scene.saturation.end(), [](float s) { return s == 0; }))
        out.push_back({Level::warning, "dry_water", "[wetness] is written, and no particle is wet",
                       "level, pattern or where of [wetness]; without the table the hair is dry and faster"});
}

}  // namespace

std::vector<Finding> findings_of(const Scene& scene) {
    std::vector<Finding> out = scene.groom_findings;
    find_roots(out, scene);
    find_meshes(out, scene);
    find_water(out, scene);
    return out;
}

void act_on(const std::vector<Finding>& findings, const Scene& scene, const std::string& scene_name) {
    for (const auto& finding : findings) {
        const bool allowed =
            std::find(scene.allow.begin(), scene.allow.end(), finding.name) != scene.allow.end();
        if (allowed || finding.level == Level::note) continue;
        const std::string text = scene_name + ": " + described(finding);
        if (finding.level == Level::error)
            throw Error(text + "; allow = [\"" + finding.name +
                        "\"] above the first table runs it all the same");
        log_warning(text);
    }
}

}  // namespace wetcurl
