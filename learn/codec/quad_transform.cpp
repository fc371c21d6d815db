// The quad transform.
// Eq 18, 19.
#include "learn/codec/quad_transform.h"

#include "base/error.h"
#include "base/geometry/kernels.h"
#include "learn/codec/transform_bound.h"

namespace wetcurl {

Reconstruction reconstruction_named(const std::string& name) {
    if (name == "paper") return Reconstruction::paper;
    if (name == "core") return Reconstruction::core;
    throw Misuse("reconstruction: found '" + name + "', allowed paper, core" +
                 did_you_mean(name, {"paper", "core"}));
}

// Of a radius [m]: Eq 18 has the gradient of a kernel [1/m^4] for a shift.
static float fifth_power(float h) { return h * h * h * h * h; }

QuadTransform::QuadTransform(Reconstruction form, Stencil stencil, const Groom& high, const Groom& low,
                             std::vector<float> saturation, float support_radius, float gain,
                             ShiftUnits units)
    : mean_(form == Reconstruction::core ? Interpolation::core : Interpolation::quad, std::move(stencil),
            high, low),
      saturation_(std::move(saturation)),
      support_radius_(support_radius),
      gain_(gain),
      unit_(units == ShiftUnits::length ? fifth_power(support_radius) : 1) {
    if (saturation_.size() != low.rest.points.size())
        throw Error("quad transform: found " + std::to_string(saturation_.size()) +
                    " saturations, allowed one a particle: " + std::to_string(low.rest.points.size()));
    if (!(support_radius > 0)) throw Error("quad transform: the support radius must be positive");
    if (!(gain >= 0)) throw Error("quad transform: the gain must be 0 or more");
}

void QuadTransform::interpolate(const Strands& low, const Pose& head, Strands& out) {
    mean_.apply(low, head, out);
}

Vec3f QuadTransform::pull(const Strands& low, int s, int i, const Vec3f& p_star) const {
    const float sigma_s = saturation_[size_t(s) * low.particles + i];
    return sigma_s * kernel_gradient(p_star - low.at(s, i), support_radius_);
}

void QuadTransform::apply(const Strands& low, const Pose& head, const std::vector<Vec3f>& colours,
                          Strands& out) {
    mean_.apply(low, head, out);
    if (int(colours.size()) != out.count)
        throw Error("quad transform: found " + std::to_string(colours.size()) +
                    " colours, allowed one a strand: " + std::to_string(out.count));
    const Stencil& stencil = mean_.stencil();
    const int n = low.particles, width = stencil.width;
#pragma omp parallel for schedule(static)
    for (int t = 0; t < out.count; ++t) {
        for (int i = 1; i < n; ++i) {
            const Vec3f p_star = out.at(t, i);
            Vec3f shift{0, 0, 0};
            for (int k = t * width; k < (t + 1) * width; ++k) {
                const float share = stencil.weight[size_t(k)];  // 1 / N
                if (share == 0) continue;
                const int s = stencil.from[size_t(k)];
                const Vec3f& c_s = colours[size_t(stencil.twin[size_t(s)])];
                const float gamma_s = share * norm(colours[size_t(t)] - c_s);
                shift += share * gamma_s * pull(low, s, i, p_star);
            }
            out.at(t, i) += gain_ * unit_ * shift;
        }
    }
}

void QuadTransform::apply_nearest(const Strands& low, const Pose& head, const Strands& truth, Strands& out) {
    mean_.apply(low, head, out);
    if (truth.count != out.count || truth.particles != out.particles)
        throw Error("quad transform: found " + std::to_string(truth.count) + " strands of " +
                    std::to_string(truth.particles) + " particles to come near to, allowed " +
                    std::to_string(out.count) + " of " + std::to_string(out.particles));
    const Stencil& stencil = mean_.stencil();
    const size_t n = size_t(low.particles);
    const int width = stencil.width;
    const double unit = fifth_power(support_radius_);  // keeps the weights near 1
#pragma omp parallel
    {
        std::vector<Vec3d> distance(n), pulls(size_t(width) * n);
#pragma omp for schedule(dynamic, 16)
        for (int t = 0; t < out.count; ++t) {
            for (size_t i = 0; i < n; ++i) {
                const Vec3f p_star = out.at(t, int(i));
                distance[i] = cast<double>(truth.at(t, int(i)) - p_star);
                for (int k = 0; k < width; ++k) {
                    const int s = stencil.from[size_t(t * width + k)];
                    const bool pulls_it = i > 0 && stencil.weight[size_t(t * width + k)] > 0;
                    pulls[size_t(k) * n + i] =
                        pulls_it ? unit * cast<double>(pull(low, s, int(i), p_star)) : Vec3d{0, 0, 0};
                }
            }
            const NeighbourWeights weight = nearest_weights(distance, pulls, width);
            for (size_t i = 0; i < n; ++i)
                for (int k = 0; k < width; ++k)
                    out.at(t, int(i)) += cast<float>(weight[size_t(k)] * pulls[size_t(k) * n + i]);
        }
    }
}

}  // namespace wetcurl
