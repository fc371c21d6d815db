// Heads, roots and skin of a scene at a time, and the space that they need.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <numbers>

#include "base/log.h"
#include "base/median.h"
#include "solver/scene/scene.h"

namespace wetcurl {

namespace {

void widen(Bounds& box, const Vec3d& low, const Vec3d& high) {
    box = {lower(box.low, low), upper(box.high, high)};
}
Bounds nothing() {
    constexpr double all = std::numeric_limits<double>::infinity();
    return {{all, all, all}, {-all, -all, -all}};
}
// Where a body is, frame by frame.
struct Track {
    std::string what, key;      // "the roots of the hair", "[motion]"
    ShotCuts cuts;              // those known
    std::vector<Vec3d> places;  // (frame) [m], one beyond the last
    std::vector<Quatd> turns;   // (frame)

    void add(const Pose& pose, const Vec3d& point) {
        places.push_back(pose(point));
        turns.push_back(pose.rotation);
    }

    // Frames at which it jumps farther than any body moves.
    std::vector<int> jumps() const {
        // A sprinter makes 12 m/s, a head in a crash 40; and no body starts and stops within a frame, nor
        // turns by a right angle in one while it hardly turns in those around.
        constexpr double fastest = 40, fast = 4, least = 0.2, most_turn = 1.5,  // [m/s], [m], [rad]
            times_the_neighbours = 8;
        std::vector<int> out;
        for (size_t f = 1; f + 1 < places.size(); ++f) {
            const double way = way_to(f), speed = way * cuts.fps,
                         around = std::max(f > 1 ? way_to(f - 1) : 0, way_to(f + 1));
            const double turn = turn_to(f),
                         turn_around = std::max(f > 1 ? turn_to(f - 1) : 0, turn_to(f + 1));
            if (speed > fastest || (speed > fast && way > least && way > times_the_neighbours * around) ||
                (turn > most_turn && turn > times_the_neighbours * turn_around))
                if (!cuts.at(int(f))) out.push_back(int(f));
        }
        return out;
    }
    // The jumps, said: cuts, where the scene says nothing of cuts.
    std::vector<int> found_cuts() const {
        const std::vector<int> found = jumps();
        if (found.empty() || (cuts.said && cuts.frames.empty())) return {};
        std::string frames;
        for (const int f : found) frames += (frames.empty() ? "" : ", ") + std::to_string(f);
        const size_t first = size_t(found[0]);
        char far[128];
        std::snprintf(far, sizeof far, "by %.3g m and %.0f degrees from frame %zu to frame %zu (%.3g m/s)",
                      way_to(first), turn_to(first) * 180 / std::numbers::pi, first - 1, first,
                      way_to(first) * cuts.fps);
        const std::string text = what + " move " + far + ", which no body does";
        if (cuts.said) {
            log_warning(text + ", and cuts of " + key + " does not name frame " + frames);
            return {};
        }
        log_warning(text + ": guessed that it is a cut, after which hair begins anew; cuts = [" + frames +
                    "] in " + key + " says so, cuts = [] that it is none");
        return found;
    }

  private:
    double way_to(size_t frame) const { return norm(places[frame] - places[frame - 1]); }
    // [rad]
    double turn_to(size_t frame) const {
        const Quatd q = turns[frame] * conjugate(turns[frame - 1]);
        return 2 * std::atan2(norm(Vec3d{q.x, q.y, q.z}), std::abs(q.w));
    }
};

// A share of the way from rest to a pose: the turn about one axis.
Pose part_of(const Pose& whole, double share) {
    Quatd q = whole.rotation;
    if (q.w < 0) q = {-q.w, -q.x, -q.y, -q.z};
    const Vec3d v{q.x, q.y, q.z};
    const double sine = norm(v);
    Pose out;
    if (sine > 0) out.rotation = rotation_about((1 / sine) * v, 2 * share * std::atan2(sine, q.w));
    out.translation = share * whole.translation;
    return out;
}

}  // namespace

std::vector<Vec3d> roots_of(const Strands& hair) {
    std::vector<Vec3d> roots;
    for (int s = 0; s < hair.count; ++s) roots.push_back(cast<double>(hair.at(s, 0)));
    return roots;
}

double reach_of_strand(const Strands& hair, int s) {
    return 1.25 * arc_length(hair.strand(s), hair.particles);
}

Bounds reach_of_roots(const Strands& hair) {
    Bounds near = nothing();
    for (int s = 0; s < hair.count; ++s) {
        const Vec3d root = cast<double>(hair.at(s, 0));
        const double r = reach_of_strand(hair, s);
        widen(near, root - Vec3d{r, r, r}, root + Vec3d{r, r, r});
    }
    return near;
}

void ride(Scene& scene, Solid& solid, const Groom& full, const std::vector<int>& kept) {
    if (solid.attached) solid.motion = scene.motion;
    solid.attached = false, solid.carries_roots = true;
    scene.riding =
        Riding{solid.motion, RidingRoots(solid.deformation, roots_of(full.rest)).kept(kept), {}, nothing()};
}

void drive_roots(Scene& scene) {
    const DrivenMotion at_rest(0, scene.head_at(0));
    scene.riding.emplace().reach = reach_of_roots(scene.groom.rest);
    scene.riding->driven.assign(size_t(scene.groom.rest.count), at_rest);
}

void Riding::poses_at(double time, RidingRoots::Room& room) const {
    if (driven.empty()) return roots->poses_at(time, motion.at(time), room);
    room.pose.resize(driven.size());
    for (size_t s = 0; s < driven.size(); ++s) room.pose[s] = driven[s].at(time);
}

Pose Riding::middle_at(double time, const Strands& rest, RidingRoots::Room& room) const {
    if (driven.empty()) return roots->middle_at(time, motion.at(time), room);
    poses_at(time, room);
    return RidingRoots::middle_of(room.pose, [&](size_t s) { return cast<double>(rest.at(int(s), 0)); });
}

// Where what a caller drives may go is not known: so far around where it is at rest.
static Bounds with_room(const Bounds& box, double share) {
    const Vec3d more = share * (box.high - box.low);
    return {box.low - more, box.high + more};
}

Solid* guessed_scalp(Scene& scene, const Groom& full) {
    constexpr double on_it = 0.01;  // [m]
    const std::vector<Vec3d> roots = roots_of(full.rest);
    for (Solid& solid : scene.solids) {
        if (!solid.attached || !solid.deformation) continue;
        const MeshDistance surface(solid.deformation->rest());
        std::vector<double> away;
        for (const Vec3d& root : roots) away.push_back(surface.closest(root).distance);
        const double typical = median(away);
        if (typical > on_it) continue;
        char text[64];
        std::snprintf(text, sizeof text, "roots lie %.1f mm from ", 1000 * typical);
        log_warning(text + ("[[solid]] '" + solid.name) +
                    "' in the median, and its mesh deforms: guessed that they "
                    "ride on it; scalp = \"" +
                    solid.name + "\" in [groom] says so");
        return &solid;
    }
    return nullptr;
}

void survey(Scene& scene, const Groom& full) {
    const auto goes_alone = [](const Solid& solid) {
        return !solid.attached && !solid.carries_roots && solid.motion.moves();
    };
    std::vector<Track> tracks;
    if (scene.riding || scene.motion.moves())
        tracks.push_back({"the roots of the hair", "[motion]", scene.cuts, {}, {}});
    const size_t of_solids = tracks.size();
    for (Solid& solid : scene.solids) {
        if (solid.driven)
            solid.region = with_room(solid.deformation->box(), 0.25);
        else if (solid.deformation && !scene.riding)
            solid.region = solid.deformation->reads_frames() ? solid.deformation->box(0, scene.end)
                                                             : solid.deformation->box();
        else
            solid.region = nothing();
        if (goes_alone(solid))
            tracks.push_back({"points of [[solid]] '" + solid.name + "'", "[solid.motion]", {}, {}, {}});
    }
    const std::vector<Vec3d> roots = roots_of(full.rest);
    Vec3d middle{0, 0, 0};
    for (const Vec3d& root : roots) middle += (1 / double(roots.size())) * root;
    RidingRoots::Room room;
    std::vector<Vec3f> vertices;
    const int frames = int(std::lround(scene.end * scene.fps));
    for (int f = 0; f <= frames + 1 && !tracks.empty(); ++f) {
        const double time = f / scene.fps;
        const Pose head = scene.head_at(time, room);
        if (of_solids) tracks[0].add(head, middle);
        size_t track = of_solids;
        for (const Solid& solid : scene.solids)
            if (goes_alone(solid)) tracks[track++].add(solid.motion.at(time), {0, 0, 0});
        if (!scene.riding || f > frames) continue;
        scene.root_poses_at(time, room);
        const Strands& hair = scene.groom.rest;
        for (int s = 0; s < hair.count; ++s) {
            const Vec3d root = head.inverse(room.pose[size_t(s)](cast<double>(hair.at(s, 0))));
            const double r = reach_of_strand(hair, s);
            widen(scene.riding->reach, root - Vec3d{r, r, r}, root + Vec3d{r, r, r});
        }
        for (Solid& solid : scene.solids) {
            if (!solid.deformation) continue;
            scene.surface_vertices(solid, time, vertices);
            for (const Vec3f& v : vertices) widen(solid.region, cast<double>(v), cast<double>(v));
        }
    }
    for (Solid& solid : scene.solids)
        if (solid.carries_roots && scene.preroll > 0)
            for (const Vec3f& v : solid.deformation->rest().vertices)
                widen(solid.region, cast<double>(v), cast<double>(v));
    if (of_solids) scene.cuts = scene.cuts.joined({tracks[0].found_cuts(), scene.fps});
    scene.motion.rest_at(scene.cuts);
    if (scene.riding) scene.riding->motion.rest_at(scene.cuts);
    size_t track = of_solids;
    for (Solid& solid : scene.solids) {
        if (goes_alone(solid)) {
            Track& own = tracks[track++];
            own.cuts = scene.cuts.joined(solid.cuts);
            own.cuts.said = solid.cuts.said;
            solid.cuts = solid.cuts.joined({own.found_cuts(), scene.fps});
        }
        const ShotCuts cuts = scene.cuts.joined(solid.cuts);
        solid.motion.rest_at(cuts);
        if (solid.deformation) solid.deformation->rest_at(cuts);
    }
}

double Scene::share_of_preroll(double time) const {
    if (!(preroll > 0) || time >= 0) return 1;
    const double s = std::max(0.0, 1 - time / begin());
    return s * s * (3 - 2 * s);
}

Pose Scene::head_at(double time, RidingRoots::Room& room) const {
    const double share = share_of_preroll(time), then = share < 1 ? 0 : time;
    const Pose head = riding ? riding->middle_at(then, groom.rest, room) : motion.at(then);
    return share < 1 ? part_of(head, share) : head;
}

void Scene::root_poses_at(double time, RidingRoots::Room& room) const {
    const double share = share_of_preroll(time), then = share < 1 ? 0 : time;
    if (share == 1) return riding->poses_at(time, room);
    const Pose first = head_at(then, room);
    riding->poses_at(then, room);
    riding->roots->lead(share, first, part_of(first, share), room);
}

void Scene::surface_vertices(const Solid& solid, double time, std::vector<Vec3f>& out) const {
    const double share = share_of_preroll(time), then = share < 1 ? 0 : time;
    solid.deformation->vertices_at(then, out);
    if (!riding) return;
    const Pose head = head_at(then), frame = solid.at(then, head);
    for (Vec3f& v : out) v = cast<float>(head.inverse(frame(cast<double>(v))));
    if (share == 1 || !solid.carries_roots) return;
    const Mesh rest = solid.deformation->rest();
    for (size_t v = 0; v < out.size(); ++v)
        out[v] = rest.vertices[v] + float(share) * (out[v] - rest.vertices[v]);
}

}  // namespace wetcurl
