// What a caller moves, and the frames between.
#include "app/engine/driven_run.h"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

namespace wetcurl {

static Scene prepared(Scene scene, const DrivenRun::Given& given) {
    bool cuts = !scene.cuts.frames.empty();
    for (const Solid& solid : scene.solids) cuts = cuts || !solid.cuts.frames.empty();
    if (cuts)
        throw Error(scene.title + ": found cuts, which are the caller's here; allowed is a scene without");
    if (!given.roots) return scene;
    if (scene.riding) throw Error(scene.title + ": roots that ride on a solid are not driven one by one");
    if (scene.preroll > 0)
        throw Error(scene.title + ": found a preroll, allowed is none for roots that are driven");
    drive_roots(scene);
    return scene;
}

DrivenRun::DrivenRun(Scene scene, const Given& given, const std::string& device, const std::string& precision,
                     int threads)
    : run_(prepared(std::move(scene), given), device, precision, threads),
      place_(size_t(run_.scene().groom.rest.count)),
      solid_is_driven_(run_.scene().solids.size()),
      watch_(run_.scene().groom, run_.scene().fps) {
    const Scene& s = run_.scene();
    std::iota(place_.begin(), place_.end(), 0);
    for (size_t k = 0; given.strands && k < place_.size(); ++k) place_[k] = s.groom.origin[k].number;
    look();
}

size_t DrivenRun::solid_named(const std::string& name) const {
    std::string names;
    for (size_t k = 0; k < scene().solids.size(); ++k) {
        if (scene().solids[k].name == name) return k;
        names += (k ? ", '" : "'") + scene().solids[k].name + "'";
    }
    throw Error(
        fmt::format("found the solid '{}', allowed: {}", name, names.empty() ? "none is there" : names));
}

void DrivenRun::move_head(const Pose& pose) {
    if (scene().riding)
        throw Error("the head goes with the roots, which are moved by themselves or ride on a solid");
    moves_.head = pose, head_is_driven_ = true;
}

void DrivenRun::move_solid(const std::string& name, const Pose& pose) {
    const size_t k = solid_named(name);
    if (scene().solids[k].attached)
        throw Error(fmt::format("[[solid]] '{}' is attached to the head and goes with it", name));
    moves_.solids[k] = pose, solid_is_driven_[k] = true;
}

size_t DrivenRun::vertices(const std::string& name) const {
    const Solid& solid = scene().solids[solid_named(name)];
    if (!solid.driven)
        throw Error(fmt::format("the mesh of [[solid]] '{}' was not brought by the caller", name));
    return solid.deformation->rest().vertices.size();
}

void DrivenRun::move_mesh(const std::string& name, std::vector<Vec3f> vertices) {
    const size_t k = solid_named(name), count = this->vertices(name);
    if (vertices.size() != count)
        throw Error(
            fmt::format("[[solid]] '{}': found {} vertices, allowed {}", name, vertices.size(), count));
    for (size_t v = 0; v < vertices.size(); ++v)
        if (const Vec3f& x = vertices[v]; !std::isfinite(x.x + x.y + x.z))
            throw Error(fmt::format("[[solid]] '{}': vertex {} is not finite", name, v));
    moves_.meshes[k] = std::move(vertices);
}

void DrivenRun::move_roots(const std::vector<Pose>& poses) {
    if (!scene().riding || scene().riding->driven.empty())
        throw Error("roots are not driven one by one; that is said before the simulation is made");
    moves_.roots.resize(place_.size());
    for (size_t s = 0; s < place_.size(); ++s) moves_.roots[s] = poses[size_t(place_[s])];
}

void DrivenRun::wet(const float* saturation) {
    const size_t n = size_t(particles());
    std::vector<double> ours(place_.size() * n);
    for (size_t s = 0; s < place_.size(); ++s)
        for (size_t i = 0; i < n; ++i) {
            const float sigma = saturation[size_t(place_[s]) * n + i];
            if (!(sigma >= 0 && sigma <= 1))
                throw Error(fmt::format("found saturation {} of strand {}, particle {}, allowed 0 to 1",
                                        sigma, place_[s], i));
            ours[s * n + i] = double(sigma);
        }
    run_.simulation().wet(ours);
}

template <class Go>
void DrivenRun::for_each_driven(Go go) {
    Scene& s = run_.scene_to_drive();
    const double now = time();
    if (head_is_driven_) {
        DrivenMotion& head = s.motion.driven_from(now);
        go(head, moves_.head.value_or(head.at_end()));
    }
    for (size_t k = 0; k < s.solids.size(); ++k) {
        Solid& solid = s.solids[k];
        if (solid_is_driven_[k]) {
            const auto moved = moves_.solids.find(k);
            DrivenMotion& motion = solid.motion.driven_from(now);
            const Pose to = moved == moves_.solids.end() ? motion.at_end() : moved->second;
            go(motion, to);
            if (solid.carries_roots) go(s.riding->motion.driven_from(now), to);
        }
        if (solid.driven) {
            const auto moved = moves_.meshes.find(k);
            go(*solid.deformation,
               moved == moves_.meshes.end() ? solid.deformation->at(now).vertices : moved->second);
        }
    }
    if (s.riding)
        for (size_t root = 0; root < s.riding->driven.size(); ++root) {
            DrivenMotion& motion = s.riding->driven[root];
            go(motion, moves_.roots.empty() ? motion.at_end() : moves_.roots[root]);
        }
    moves_ = {};
}

void DrivenRun::advance(double seconds) {
    if (!(seconds >= 0 && seconds <= longest_frame))
        throw Error(fmt::format("found a frame of {} s, allowed 0 to {} s", seconds, longest_frame));
    if (seconds == 0) return;
    const double end = time() + seconds;
    for_each_driven([end](auto& body, auto to) { body.go_to(end, std::move(to)); });
    run_.simulation().advance_by(seconds);
    ++frames_;
    if (const auto divergence = run_.simulation().divergence())
        throw Diverged(run_.scene(), frames_, *divergence);
    look();
}

void DrivenRun::cut() {
    run_.simulation().cut(
        [&] { for_each_driven([now = time()](auto& body, auto to) { body.jump_to(now, std::move(to)); }); });
    look();
}

void DrivenRun::look() {
    run_.simulation().snapshot(frame_);
    watch_.look(frames_, frame_);
    require_bearable(run_.simulation(), watch_, frame_, time());
}

void DrivenRun::saturation(float* to) const {
    const std::vector<float>& now = frame_.saturation.empty() ? scene().saturation : frame_.saturation;
    give(now.empty() ? std::vector<float>(frame_.positions.points.size(), 0) : now, to);
}

}  // namespace wetcurl
