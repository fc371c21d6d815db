// The rest state of strands.
#include "solver/rest_state.h"

#include <algorithm>

#include "base/geometry/filter.h"
#include "base/geometry/frames.h"
#include "solver/deforming_solids.h"

namespace wetcurl {

std::vector<Quatd> frames_along(const std::vector<Vec3d>& p) {
    std::vector<Quatd> frame{root_frame_of(normalized(p[1] - p[0], Vec3d{1, 0, 0}))};
    for (size_t i = 1; i + 1 < p.size(); ++i)
        frame.push_back(
            transported(frame.back(), normalized(p[i + 1] - p[i], frame_direction(frame.back()))));
    return frame;
}

namespace {

std::vector<double> core_lengths(const std::vector<Vec3d>& p, double beta) {
    std::vector<double> out(p.size() - 1);
    smooth_edges<double>(
        int(out.size()), beta, [&](int i) { return p[size_t(i) + 1] - p[size_t(i)]; },
        [&](int i, const Vec3d& b) { out[size_t(i)] = norm(b); });
    return out;
}

std::vector<double> masses(const Scene& scene, int s, const std::vector<Vec3d>& p) {
    const size_t n = p.size();
    std::vector<double> mass(n, 0);
    for (size_t i = 0; i + 1 < n; ++i) {
        const double half = 0.5 * scene.linear_density * norm(p[i + 1] - p[i]);
        mass[i] += half;
        mass[i + 1] += half;
    }
    if (scene.wetness)
        for (size_t i = 0; i < n; ++i)
            mass[i] *= 1 + scene.wetness->absorbed * scene.saturation[size_t(s) * n + i];
    return mass;
}

// The drawn shape as an equilibrium: from the tip, edge i must pass on the weight below it (f_i = G_i -
// G_{i-1}). What lies along the edge goes to the stretch's rest length, the rest to the bend's target. The
// bends then turn their frames, which the twist must hold: the angle at each edge [rad] is returned.
std::vector<double> free_of_sag(const Scene& scene, const std::vector<Vec3d>& p,
                                const std::vector<double>& dry_mass, StrandRest& rest) {
    const size_t edges = p.size() - 1;
    const double k_s = scene.term<Stretch>() ? scene.term<Stretch>()->k_s : 0;
    const Bend& bend = *scene.term<Bend>();
    const auto& twist = scene.term<Twist>();
    const std::vector<Quatd> frame = frames_along(p);
    std::vector<Vec3d> target(edges, Vec3d{0, 0, 0});
    std::vector<double> angle(edges, 0);
    Vec3d weight{0, 0, 0}, reaction{0, 0, 0};
    double torque = 0;  // of the twist between edges i and i+1
    for (size_t i = edges - 1; i >= 1; --i) {
        const Vec3d e = p[i + 1] - p[i], before = p[i] - p[i - 1];
        if (twist && i + 1 < edges) {
            double slope, bound;
            bend_by_turn(bend, frame[i], rotate(conjugate(frame[i]), target[i + 1]), p[i + 2] - p[i + 1],
                         slope, bound);
            torque -= slope;
        }
        const auto gradient = Twist::gradient(before, e);
        weight += dry_mass[i + 1] * scene.integrator.gravity;  // G_i, all the weight beyond edge i
        const Vec3d need = weight - reaction - torque * gradient.after;
        const double l = norm(e);
        const Vec3d e_hat = normalized(e, Vec3d{1, 0, 0});
        const double pull = k_s > 0 ? dot(need, e_hat) : 0;
        if (k_s > 0) rest.rest_length[i] = l - pull / k_s;
        if (twist)
            angle[i] = std::asin(std::clamp(torque / twist->stiffness(rest.rest_length[i]), -0.99, 0.99));
        const Vec3d g = need - pull * e_hat, t = e - (1 / bend.k_b) * g;
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

StrandRest rest_state_of(const Scene& scene, int s) {
    const int n = scene.groom.rest.particles;
    std::vector<Vec3d> p;
    for (int i = 0; i < n; ++i) p.push_back(cast<double>(scene.groom.rest.at(s, i)));
    StrandRest rest;
    rest.start = p;
    rest.mass = masses(scene, s, p);
    for (int i = 0; i + 1 < n; ++i) rest.rest_length.push_back(norm(p[size_t(i) + 1] - p[size_t(i)]));
    rest.target = intrinsic_shape(p);
    std::vector<double> angle(size_t(n) - 1, 0);
    if (scene.rest == "sag_free") {
        Scene dry_weight;
        dry_weight.linear_density = scene.linear_density;
        angle = free_of_sag(scene, p, masses(dry_weight, s, p), rest);
    }
    const auto& core = scene.term<Core>();
    if (core) rest.rest_core = core_lengths(p, core->beta);
    const float* sigma = scene.saturation.empty() ? nullptr : scene.saturation.data() + size_t(s) * size_t(n);
    if (scene.curl && !scene.curl->printed) {
        const auto dry = rest.target;
        rest.target = curled(*scene.curl, dry, sigma);
        // From the drawn shape a curl would tighten by whole turns at once, and end in a tangle. So the
        // strand begins as its wet curl.
        const Quatd root = root_frame_of(normalized(p[1] - p[0], Vec3d{1, 0, 0}));
        rest.start = shape_from_intrinsic(curled(*scene.curl, intrinsic_shape(p), sigma), p[0], root);
        if (core) {
            const Quatd frame = Quatd::identity();
            const auto before = core_lengths(shape_from_intrinsic(dry, {0, 0, 0}, frame), core->beta);
            const auto after = core_lengths(shape_from_intrinsic(rest.target, {0, 0, 0}, frame), core->beta);
            for (size_t i = 0; i < before.size(); ++i)
                if (after[i] != before[i]) rest.rest_core[i] *= after[i] / before[i];
        }
    }
    rest.frame = frames_along(rest.start);
    for (size_t i = 1; i < rest.frame.size(); ++i)
        rest.frame[i] = turned_about_itself(rest.frame[i], angle[i]);
    return rest;
}

std::vector<float> rest_depths_of(const Scene& scene) {
    const auto& points = scene.groom.rest.points;
    std::vector<float> depth(scene.has_attached_solid() ? points.size() : 0, 0.f);
    auto deepen = [&](const auto& shape) {
#pragma omp parallel for schedule(static)
        for (size_t k = 0; k < depth.size(); ++k)
            depth[k] = std::min(depth[k], float(distance(shape, cast<double>(points[k])).phi));
    };
    for (const auto& solid : scene.solids)
        if (solid.attached && !solid.deformation) deepen(solid.shape);
    if (depth.empty() || !scene.has_deforming_solid()) return depth;
    // By the level sets that contact will see.
    const DeformingSolids surfaces(scene);
    const MovingGrid* surface = surfaces.at_end();
    for (const auto& solid : scene.solids) {
        if (!solid.deformation) continue;
        if (solid.attached) deepen(*surface);
        ++surface;
    }
    return depth;
}

std::vector<float> volumes_of(const Scene& scene) {
    std::vector<float> out;
    const int n = scene.groom.rest.particles;
    for (int s = 0; s < scene.groom.rest.count; ++s) {
        std::vector<Vec3d> p;
        for (int i = 0; i < n; ++i) p.push_back(cast<double>(scene.groom.rest.at(s, i)));
        for (double m : masses(scene, s, p)) out.push_back(float(m / scene.volume_density));
    }
    return out;
}

}  // namespace wetcurl
