// The rest state of strands.
#include "solver/rest_state.h"

#include <algorithm>

#include "base/geometry/filter.h"
#include "base/geometry/frames.h"

namespace wetcurl {

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
// G_{i-1}). What lies along the edge goes to the stretch's rest length, the rest to the bend's target.
void free_of_sag(const Scene& scene, const std::vector<Vec3d>& p, const std::vector<double>& dry_mass,
                 StrandRest& rest) {
    const int edges = int(p.size()) - 1;
    const double k_s = scene.term<Stretch>() ? scene.term<Stretch>()->k_s : 0, k_b = scene.term<Bend>()->k_b;
    std::vector<Quatd> frame{root_frame_of(normalized(p[1] - p[0], Vec3d{1, 0, 0}))};
    for (int i = 1; i < edges; ++i)
        frame.push_back(transported(
            frame.back(), normalized(p[size_t(i) + 1] - p[size_t(i)], frame_direction(frame.back()))));
    Vec3d carried{0, 0, 0}, reaction{0, 0, 0};
    for (int i = edges - 1; i >= 1; --i) {
        const size_t k = size_t(i);
        carried += dry_mass[k + 1] * scene.integrator.gravity;  // G_i, all the weight beyond edge i
        const Vec3d e = p[k + 1] - p[k], need = carried - reaction;
        const double l = norm(e);
        const Vec3d e_hat = normalized(e, Vec3d{1, 0, 0});
        const double pull = k_s > 0 ? dot(need, e_hat) : 0;
        if (k_s > 0) rest.rest_length[k] = l - pull / k_s;
        const Vec3d g = need - pull * e_hat, t = e - (1 / k_b) * g;
        rest.target[k] = rotate(conjugate(frame[k - 1]), t);
        const Vec3d before = p[k] - p[k - 1];
        reaction = (1 / dot(before, before)) * (dot(before, g) * t - dot(t, before) * g);
    }
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
    if (scene.rest == "sag_free") {
        Scene dry_weight;
        dry_weight.linear_density = scene.linear_density;
        free_of_sag(scene, p, masses(dry_weight, s, p), rest);
    }
    const auto& core = scene.term<Core>();
    if (core) rest.rest_core = core_lengths(p, core->beta);
    const float* sigma = scene.saturation.empty() ? nullptr : scene.saturation.data() + size_t(s) * size_t(n);
    if (scene.curl && !scene.curl->printed) {
        const auto dry = rest.target;
        rest.target = curled(*scene.curl, dry, sigma);
        // From the drawn shape a curl would tighten with its frames untwisted, and end in a tangle: they are
        // carried through time, and the tighter curl has another twist. So the strand begins as its wet curl.
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
    return rest;
}

std::vector<float> rest_depths_of(const Scene& scene) {
    const auto& points = scene.groom.rest.points;
    std::vector<float> depth(scene.has_attached_solid() ? points.size() : 0, 0.f);
#pragma omp parallel for schedule(static)
    for (size_t k = 0; k < depth.size(); ++k)
        for (const auto& solid : scene.solids)
            if (solid.attached)
                depth[k] = std::min(depth[k], float(distance(solid.shape, cast<double>(points[k])).phi));
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
