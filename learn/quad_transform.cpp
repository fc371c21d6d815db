// The quad transform.
// Eq 18, 19.
#include "learn/quad_transform.h"

#include "base/error.h"
#include "base/geometry/kernels.h"

namespace wetcurl {

Reconstruction reconstruction_named(const std::string& name) {
    if (name == "paper") return Reconstruction::paper;
    if (name == "core") return Reconstruction::core;
    throw Misuse("reconstruction: found '" + name + "', allowed paper, core" +
                 did_you_mean(name, {"paper", "core"}));
}

QuadTransform::QuadTransform(Reconstruction form, Stencil stencil, const Groom& high, const Groom& low,
                             std::vector<float> saturation, float support_radius, float gain)
    : mean_(form == Reconstruction::core ? Interpolation::core : Interpolation::quad, std::move(stencil),
            high, low),
      saturation_(std::move(saturation)),
      support_radius_(support_radius),
      gain_(gain) {
    if (saturation_.size() != low.rest.points.size())
        throw Error("quad transform: found " + std::to_string(saturation_.size()) +
                    " saturations, allowed one a particle: " + std::to_string(low.rest.points.size()));
    if (!(support_radius > 0)) throw Error("quad transform: the support radius must be positive");
}

void QuadTransform::apply(const Strands& low, const Pose& head, const std::vector<Vec3f>& colours,
                          Strands& out) {
    mean_.apply(low, head, out);
    if (int(colours.size()) != out.count)
        throw Error("quad transform: found " + std::to_string(colours.size()) +
                    " colours, allowed one a strand: " + std::to_string(out.count));
    const Stencil& stencil = mean_.stencil();
    const int n = low.particles, width = stencil.width;
    const float h = support_radius_, h5 = h * h * h * h * h;
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
                const float sigma_s = saturation_[size_t(s) * n + i];
                shift += share * sigma_s * gamma_s * kernel_gradient(p_star - low.at(s, i), h);
            }
            out.at(t, i) += gain_ * h5 * shift;
        }
    }
}

}  // namespace wetcurl
