// Sanity of scenes.
#include "solver/scene/findings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/log.h"
#include "base/median.h"
#include "base/number_text.h"
#include "solver/grooms/neighbourhood.h"

namespace wetcurl {

using Level = Finding::Level;

namespace {

// Without what rounding leaves.
std::string in_millimetres(double metres) {
    return fmt::format("{:.3g} mm", metres < 5e-6 ? 0 : 1e3 * metres);
}

// Surfaces that move with the roots, in the pose of the hair at rest.
class SurfacesOfHead {
  public:
    explicit SurfacesOfHead(const Scene& scene) {
        for (const auto& solid : scene.solids) {
            if (!solid.moves_with_roots()) continue;
            Surface& surface = surfaces_.emplace_back();
            surface.name = solid.name;
            if (solid.deformation)
                surface.mesh.emplace(solid.deformation->rest());
            else
                surface.shape = &solid.shape;
            const Bounds box =
                solid.deformation ? bounding_box(solid.deformation->rest()) : bounds_of(solid.shape);
            size_ = std::max(size_, norm(box.high - box.low));
        }
    }
    struct Surface {
        std::string name;
        const Shape* shape = nullptr;  // of a rigid one; in its place:
        std::optional<MeshDistance> mesh;
        // Signed [m].
        double distance_to(const Vec3d& x) const {
            if (shape) return distance(*shape, x).phi;
            return (mesh->inside(x) ? -1 : 1) * mesh->closest(x).distance;
        }
    };
    const std::vector<Surface>& surfaces() const { return surfaces_; }
    // From the nearest of them, signed [m].
    double distance_to(const Vec3d& x) const {
        double nearest = 1e300;
        for (const Surface& surface : surfaces_) nearest = std::min(nearest, surface.distance_to(x));
        return nearest;
    }
    // Diagonal of the largest one [m]; 0 where one has no end.
    double size() const { return std::isfinite(size_) ? size_ : 0; }

  private:
    std::vector<Surface> surfaces_;
    double size_ = 0;
};

// How roots lie on a surface.
struct RootsOnSurface {
    double usual = 0, most = 0, deepest = 0;  // distance in the median and at most, depth at most [m]
    size_t farthest = 0, below = 0;           // strand; how many lie below it
    explicit RootsOnSurface(const std::vector<double>& distances) {  // (strand) signed [m]
        std::vector<double> away;
        for (const double phi : distances) {
            away.push_back(std::abs(phi));
            if (phi < 0) ++below, deepest = std::max(deepest, -phi);
        }
        farthest = size_t(std::max_element(away.begin(), away.end()) - away.begin());
        usual = median(away), most = away[farthest];
    }
    // "roots lie 1 mm from the head in the median, 3 mm at most (strand 7); 2 of 50 below its surface, ...".
    std::string text(const std::string& surface, size_t strands, int farthest_number) const {
        return fmt::format(
            "roots lie {} from {} in the median, {} at most (strand {}); {} of {} below its surface{}",
            in_millimetres(usual), surface, in_millimetres(most), farthest_number, below, strands,
            below ? ", by " + in_millimetres(deepest) + " at most" : "");
    }
};

constexpr double off = 0.008, far = 0.03, too_far = 0.3;  // of roots from what they should lie on [m]

void find_roots(std::vector<Finding>& out, const Scene& scene) {
    const SurfacesOfHead head(scene);
    if (head.surfaces().empty()) return;
    const auto& hair = scene.groom.rest;
    std::vector<double> distances;
    const std::vector<StrandOrigin> origins = origins_of(scene.groom);
    std::vector<size_t> turned_round;  // numbers of strands whose tip is the nearer end
    Vec3d low{1e300, 1e300, 1e300}, high{-1e300, -1e300, -1e300};
    for (int s = 0; s < hair.count; ++s) {
        const Vec3d root = cast<double>(hair.at(s, 0)), tip = cast<double>(hair.at(s, hair.particles - 1));
        const double phi = head.distance_to(root);
        constexpr double clearly = 0.02;  // [m]
        // A root inside it says nothing.
        if (std::abs(head.distance_to(tip)) + clearly < phi)
            turned_round.push_back(size_t(origins[size_t(s)].number));
        distances.push_back(phi);
        for (const Vec3d& x : {root, tip}) low = lower(low, x), high = upper(high, x);
    }
    std::sort(turned_round.begin(), turned_round.end());
    const auto text_of = [&](const RootsOnSurface& roots, const std::string& surface) {
        return roots.text(surface, distances.size(), origins[roots.farthest].number);
    };
    const RootsOnSurface roots(distances);
    const double usual = roots.usual;
    const std::string place = text_of(roots, "the head");
    const auto deep = std::ranges::count_if(distances, [](double phi) { return phi < -off; });
    const bool tips_first = double(turned_round.size()) > 0.5 * hair.count;
    std::vector<size_t> lost;
    for (size_t s = 0; s < distances.size(); ++s)
        if (std::abs(distances[s]) > too_far) lost.push_back(size_t(origins[s].number));
    std::sort(lost.begin(), lost.end());
    if (usual <= too_far && !lost.empty())
        out.push_back({Level::error, "roots_off_head",
                       fmt::format("{} of {} roots lie more than {} from the head: strands {}", lost.size(),
                                   hair.count, in_millimetres(too_far), listed(lost, 8)),
                       "a file without these strands, if they are no hair"});
    if (usual > too_far)
        out.push_back({Level::error, "roots_off_head", place,
                       "units, up, scale and offset of [groom] or of the [[solid]] that is the head"});
    else if (usual > far && !tips_first)
        out.push_back({Level::warning, "roots_off_head", place,
                       "units, up, scale and offset of [groom] or of the [[solid]] that is the head"});
    else if (usual > off && !tips_first)
        out.push_back(
            {Level::warning, "roots_off_head", place,
             "if roots should lie on it: the pose of the groom (rest, first_file_frame, offset), or "
             "the head exported as it is drawn, with its subdivision"});
    else if (double(deep) > 0.05 * hair.count)
        out.push_back(
            {Level::warning, "roots_off_head",
             fmt::format("{}; {} more than {}, and hair is pushed out there", place, deep,
                         in_millimetres(off)),
             "if they should lie on it: scale, offset or radius of the [[solid]] that they lie in, or "
             "allow = [\"roots_off_head\"]"});
    else
        out.push_back({Level::note, "roots_off_head", place, ""});
    // Where more than one is attached, of each.
    for (const auto& surface : head.surfaces()) {
        if (head.surfaces().size() < 2) break;
        std::vector<double> own;
        for (const Vec3d& root : roots_of(hair)) own.push_back(surface.distance_to(root));
        out.push_back({Level::note, "roots_off_head",
                       text_of(RootsOnSurface(own), fmt::format("[[solid]] '{}'", surface.name)), ""});
    }
    const double across = norm(high - low), size = head.size();
    constexpr double ratio = 12;
    if (size > ratio * across || (size > 0 && size * ratio < across))
        out.push_back({usual > too_far || size > ratio * across ? Level::error : Level::warning, "head_size",
                       fmt::format("the head is {:.3g} m across, the hair {:.3g} m", size, across),
                       "units of [groom] or of the [[solid]] that is the head"});
    const bool fits = size == 0 || (size <= ratio * across && size * ratio >= across);
    const std::string turned =
        fmt::format("{} of {} strands end nearer to the head than they begin{}", turned_round.size(),
                    hair.count, turned_round.empty() ? "" : ": strands " + listed(turned_round, 8));
    if (!fits) return;  // which end is nearer says nothing
    const bool of_file = !scene.groom.origin.empty();
    if (tips_first)
        out.push_back({Level::error, "order", turned,
                       of_file
                           ? "order = \"tip_first\" in [groom], if the file's strands run from tip to root"
                           : "place and size of the [[solid]] that is the head"});
    else if (double(turned_round.size()) > 0.05 * hair.count)
        out.push_back({Level::warning, "order", turned,
                       of_file ? "those strands turned round in their file, if they run from tip to root"
                               : "place and size of the [[solid]] that is the head"});
}

// Hair that lies on a mesh that deforms, and does not ride on it.
void find_riding(std::vector<Finding>& out, const Scene& scene) {
    if (scene.riding || scene.has_solid_with_roots()) return;
    constexpr double on_it = 0.01;  // [m]
    for (const auto& solid : scene.solids) {
        if (!solid.deformation) continue;
        const MeshDistance surface(solid.deformation->rest());
        const Pose pose = solid.motion.at(0);
        std::vector<double> away;
        for (const Vec3d& root : roots_of(scene.groom.rest))
            away.push_back(surface.closest(pose.inverse(root)).distance);
        if (median(away) < on_it)
            out.push_back(
                {Level::warning, "roots_off_head",
                 fmt::format("roots lie {} from [[solid]] '{}' in the median, which deforms, and do "
                             "not move with it",
                             in_millimetres(median(away)), solid.name),
                 fmt::format("scalp = \"{}\" in [groom]", solid.name)});
    }
}

// Whether hair comes as near to a source of water, while it flows, as its strands reach.
bool touches_hair(const WaterSource& source, const Scene& scene) {
    const Strands& hair = scene.groom.rest;
    RidingRoots::Room room;
    // The last step of a run leads from its last frame but one to its last.
    const int first = int(std::floor(source.from * scene.fps)),
              last = int(std::lround(scene.end * scene.fps)) - 2;
    for (int frame = first; frame <= last && frame / scene.fps < source.until; ++frame) {
        const double time = std::max(source.from, frame / scene.fps);
        const FlowingSource water = source.over(time, 1 / scene.fps);
        const Pose head = scene.head_at(time, room);
        if (scene.riding) scene.root_poses_at(time, room);
        for (int s = 0; s < hair.count; ++s) {
            const Vec3d root = (scene.riding ? room.pose[size_t(s)] : head)(cast<double>(hair.at(s, 0)));
            if (distance(water.shape, water.pose.inverse(root) - water.center).phi < reach_of_strand(hair, s))
                return true;
        }
    }
    return false;
}

void find_water(std::vector<Finding>& out, const Scene& scene) {
    if (!scene.wetness || scene.saturation.empty() || scene.endless) return;
    const bool dry =
        std::all_of(scene.saturation.begin(), scene.saturation.end(), [](float s) { return s == 0; });
    if (!scene.flow) {
        if (dry)
            out.push_back({Level::warning, "dry_water", "[wetness] is written, and no particle is wet",
                           "level, pattern, center or radius of [wetness]; without the table the hair is dry "
                           "and faster"});
        return;
    }
    if (dry && scene.flow->sources.empty())
        out.push_back({Level::warning, "dry_water",
                       "[wetness.flow] moves water, no particle is wet, and there is no [[wetness.source]]",
                       "level, pattern, center or radius of [wetness], or a source"});
    for (size_t k = 0; k < scene.flow->sources.size(); ++k)
        if (const WaterSource& source = scene.flow->sources[k];
            scene.frames > 1 && (source.rate == 0 || !touches_hair(source, scene)))
            out.push_back({Level::warning, "dry_water",
                           fmt::format("[[wetness.source]] {} wets no strand from {:g} s to "
                                       "{:g} s of the scene's {:g} s",
                                       k + 1, source.from, std::min(source.until, scene.end), scene.end),
                           "rate, center, radius, motion, from or until of that source"});
}

// Searches for neighbours that find far more of them than any effect needs: a frame takes minutes.
void find_wide_radii(std::vector<Finding>& out, const Scene& scene) {
    constexpr double too_many = 2000, plenty = 100;
    struct Search {
        const char *table, *key;
        double radius;  // [m]
    };
    if (const auto& boundary = scene.baseline<BoundaryParticles2013>()) {
        const double found = std::numbers::pi * std::pow(boundary->h / boundary->spacing, 2);
        if (found > too_many)
            out.push_back({Level::warning, "wide_radius",
                           fmt::format("a particle at a solid has about {:.0f} boundary particles within "
                                       "boundary_range of [{}], {}, and a frame takes a time that grows "
                                       "with them",
                                       found, BoundaryParticles2013::table, in_millimetres(boundary->h)),
                           fmt::format("boundary_range = {:.2g} in [{}], two and a half times their spacing",
                                       2.5 * boundary->spacing, BoundaryParticles2013::table)});
    }
    std::vector<Search> radii;
    if (scene.cohesion && scene.cohesion->neighbours == 0)
        radii.push_back({Cohesion::table, "radius", scene.cohesion->h_c});
    if (scene.strand_contact) radii.push_back({StrandContact::table, "radius", scene.strand_contact->radius});
    if (scene.flow && scene.flow->exchange > 0) radii.push_back({Flow::table, "reach", scene.flow->reach});
    if (const auto& lin = scene.baseline<Lin2015>()) radii.push_back({Lin2015::table, "radius", lin->h});
    if (const auto& kim = scene.baseline<Kim2016>()) radii.push_back({Kim2016::table, "radius", kim->h});
    if (radii.empty()) return;
    const Neighbourhood around(scene.groom.rest);
    for (const auto& [table, key, radius] : radii)
        if (const double found = around.within(radius); found > too_many)
            out.push_back(
                {Level::warning, "wide_radius",
                 fmt::format("a particle has {:.0f} of other strands within the {} of [{}], {}, and a "
                             "frame takes a time that grows with them",
                             found, key, table, in_millimetres(radius)),
                 fmt::format("{} = {:.2g} in [{}], which holds {:g}", key, around.radius_of(plenty), table,
                             plenty)});
}

}  // namespace

std::vector<Finding> findings_of(const Scene& scene) {
    std::vector<Finding> out = scene.groom_findings;
    find_roots(out, scene);
    find_riding(out, scene);
    for (const auto& solid : scene.solids)
        out.insert(out.end(), solid.findings.begin(), solid.findings.end());
    find_water(out, scene);
    find_wide_radii(out, scene);
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
