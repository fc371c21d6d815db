// The rest state of strands.
#include "solver/scene/rest_state.h"

#include <algorithm>

#include "base/geometry/filter.h"
#include "base/geometry/frames.h"

namespace wetcurl {

std::vector<Quatd> frames_along(const std::vector<Vec3d>& p) {
    std::vector<Quatd> frame{root_frame_of(normalized(p[1] - p[0], Vec3d{1, 0, 0}))};
    for (size_t i = 1; i + 1 < p.size(); ++i) frame.push_back(transported(frame.back(), p[i + 1] - p[i]));
    return frame;
}

std::vector<double> dry_masses(const std::vector<Vec3d>& p, double density) {
    std::vector<double> mass(p.size(), 0);
    for (size_t i = 0; i + 1 < p.size(); ++i) {
        const double half = 0.5 * density * norm(p[i + 1] - p[i]);
        mass[i] += half;
        mass[i + 1] += half;
    }
    return mass;
}

std::vector<double> dry_masses(const Scene& scene, int s) {
    const std::vector<Vec3d> p = points_of(scene.groom.rest, s);
    if (!scene.fibre) return dry_masses(p, scene.linear_density);
    return scene.fibre->masses(edge_lengths(p), scene.thickness_of(s));
}

std::vector<double> edge_lengths(const std::vector<Vec3d>& p) {
    std::vector<double> out;
    for (size_t i = 0; i + 1 < p.size(); ++i) out.push_back(norm(p[i + 1] - p[i]));
    return out;
}

std::vector<Vec3d> points_of(const Strands& strands, int s) {
    std::vector<Vec3d> p;
    for (int i = 0; i < strands.particles; ++i) p.push_back(cast<double>(strands.at(s, i)));
    return p;
}

std::vector<double> core_lengths(const std::vector<Vec3d>& p, double beta) {
    std::vector<double> out(p.size() - 1);
    smoothed_lengths(int(out.size()), beta, p.data(), [&](int i, double length) { out[size_t(i)] = length; });
    return out;
}

namespace {

// Of the strand that has the intrinsic shape `tbar`.
std::vector<double> core_lengths_of(const std::vector<Vec3d>& tbar, double beta) {
    return core_lengths(shape_from_intrinsic(tbar, {0, 0, 0}, Quatd::identity()), beta);
}

const float* saturation_along(const Scene& scene, int s) {
    return scene.saturation.empty()
               ? nullptr
               : scene.saturation.data() + size_t(s) * size_t(scene.groom.rest.particles);
}

// `saturation` (n); read where the scene has [wetness].
void wet(const Scene& scene, std::vector<double>& mass, const float* saturation) {
    if (scene.wetness)
        for (size_t i = 0; i < mass.size(); ++i) mass[i] = scene.wetness->wet_mass(mass[i], saturation[i]);
}

// The drawn shape as an equilibrium: from the tip, edge i must pass on the weight below it (f_i = G_i -
// G_{i-1}). What lies along the edge goes to the stretch's rest length, the rest to the bend's target. The
// bends then turn their frames, which the twist must hold: the angle at each edge [rad] is returned.
std::vector<double> free_of_sag(const Scene& scene, const std::vector<Vec3d>& p,
                                const std::vector<double>& dry_mass, const Fibre::Springs& springs,
                                StrandRest& rest) {
    const size_t edges = p.size() - 1;
    // Of the dry strand: a drawn style is what it looks like dry.
    const Bend& bend = *scene.term<Bend>();
    const auto& twist = scene.term<Twist>();
    const auto own = [](const std::vector<double>& all, size_t i) { return all.empty() ? nullptr : &all[i]; };
    const auto stretch_spring = [&](size_t i) {
        if (!scene.term<Stretch>()) return 0.0;
        return springs.empty() ? scene.term<Stretch>()->k_s : springs.stretch[i];
    };
    const auto bend_spring = [&](size_t i) { return springs.empty() ? bend.k_b : springs.bend[i]; };
    const std::vector<Quatd> frame = frames_along(p);
    std::vector<Vec3d> target(edges, Vec3d{0, 0, 0});
    std::vector<double> angle(edges, 0);
    Vec3d weight{0, 0, 0}, reaction{0, 0, 0};
    double torque = 0;  // of the twist between edges i and i+1
    for (size_t i = edges - 1; i >= 1; --i) {
        const Vec3d e = p[i + 1] - p[i], before = p[i] - p[i - 1];
        if (twist && i + 1 < edges) {
            double slope, bound;
            bend_by_turn(bend_spring(i + 1), frame[i], rotate(conjugate(frame[i]), target[i + 1]),
                         p[i + 2] - p[i + 1], slope, bound);
            torque -= slope;
        }
        const auto gradient = Twist::gradient(Twist::Direction<double>(before), Twist::Direction<double>(e));
        weight += dry_mass[i + 1] * scene.integrator.gravity;  // G_i, all the weight beyond edge i
        const Vec3d need = weight - reaction - torque * gradient.after;
        const double l = norm(e);
        const Vec3d e_hat = normalized(e, Vec3d{1, 0, 0});
        const double k_s = stretch_spring(i), pull = k_s > 0 ? dot(need, e_hat) : 0;
        if (k_s > 0) rest.rest_length[i] = l - pull / k_s;
        if (twist)
            angle[i] = std::asin(std::clamp(
                torque / twist->stiffness(own(springs.twist, i), rest.rest_length[i]), -0.99, 0.99));
        const Vec3d g = need - pull * e_hat, t = e - (1 / bend_spring(i)) * g;
        target[i] = t;
        reaction =
            (1 / dot(before, before)) * (dot(before, g) * t - dot(t, before) * g) + torque * gradient.before;
    }
    for (size_t i = 1; i < edges; ++i) {
        rest.target[i] = rotate(conjugate(turned_about_itself(frame[i - 1], angle[i - 1])), target[i]);
        angle[i] += angle[i - 1];
    }
    return angle;
}

}  // namespace

double mean_segment(const Groom& groom) {
    double sum = 0;
    for (int s = 0; s < groom.rest.count; ++s) sum += arc_length(groom.rest.strand(s), groom.rest.particles);
    return sum / (double(groom.rest.count) * (groom.rest.particles - 1));
}

void soak(const Scene& scene, const Soaking& soaking, const float* saturation, StrandRest& rest,
          std::vector<Vec3d>& points) {
    rest.mass = soaking.dry_mass;
    wet(scene, rest.mass, saturation);
    if (scene.fibre)
        rest.springs = scene.fibre->soaked(soaking.springs, scene.wetness ? saturation : nullptr);
    if (!soaking.curl) return;
    soaking.curl->at(saturation, rest.target, points);
    if (soaking.core.empty()) return;
    rest.rest_core.resize(soaking.core.size());
    core_of_curl(int(soaking.core.size()), scene.term<Core>()->beta, rest.target.data(), soaking.core.data(),
                 soaking.rest_core.data(), points.data(),
                 [&](size_t i, double length) { rest.rest_core[i] = length; });
}

StrandRest rest_state_of(const Scene& scene, int s, Soaking* soaking) {
    const std::vector<Vec3d> p = points_of(scene.groom.rest, s);
    Soaking own;
    Soaking& dry = soaking ? *soaking : own;
    dry = {};
    dry.dry_mass = dry_masses(scene, s);
    StrandRest rest;
    rest.start = p;
    rest.rest_length = edge_lengths(p);
    if (scene.fibre) dry.springs = scene.fibre->springs(rest.rest_length, scene.thickness_of(s));
    rest.target = intrinsic_shape(p);
    std::vector<double> angle(p.size() - 1, 0);
    if (scene.rest == "sag_free") angle = free_of_sag(scene, p, dry.dry_mass, dry.springs, rest);
    const auto& core = scene.term<Core>();
    if (core) rest.rest_core = core_lengths(p, core->beta);
    const float* sigma = saturation_along(scene, s);
    if (scene.curl && !scene.curl->printed) {
        dry.curl.emplace(*scene.curl, rest.target);
        if (core) dry.rest_core = rest.rest_core, dry.core = core_lengths_of(rest.target, core->beta);
        // From the drawn shape a curl would tighten by whole turns at once, and end in a tangle. So the
        // strand begins as its wet curl.
        const Quatd root = root_frame_of(normalized(p[1] - p[0], Vec3d{1, 0, 0}));
        const auto wet =
            scene.rest == "sag_free" ? curled(*scene.curl, intrinsic_shape(p), sigma) : dry.curl->at(sigma);
        rest.start = shape_from_intrinsic(wet, p[0], root);
    }
    std::vector<Vec3d> room;
    soak(scene, dry, sigma, rest, room);
    rest.frame = frames_along(rest.start);
    for (size_t i = 1; i < rest.frame.size(); ++i)
        rest.frame[i] = turned_about_itself(rest.frame[i], angle[i]);
    return rest;
}

Strands shape_at_rest(const Scene& scene) {
    Strands out(scene.groom.rest.count, scene.groom.rest.particles);
#pragma omp parallel for schedule(static)
    for (int s = 0; s < out.count; ++s) {
        const StrandRest rest = rest_state_of(scene, s);
        for (int i = 0; i < out.particles; ++i) out.at(s, i) = cast<float>(rest.start[size_t(i)]);
    }
    return out;
}

std::vector<float> volumes_of(const Scene& scene) {
    std::vector<float> out;
    for (int s = 0; s < scene.groom.rest.count; ++s) {
        auto mass = dry_masses(scene, s);
        wet(scene, mass, saturation_along(scene, s));
        for (double m : mass) out.push_back(float(m / scene.volume_density));
    }
    return out;
}

}  // namespace wetcurl
