// What low-resolution strands carry to the new roots.
#include "learn/codec/interpolate.h"

#include <algorithm>

#include "base/error.h"
#include "learn/codec/core_detail.h"

namespace wetcurl {

Interpolation interpolation_named(const std::string& name) {
    static const std::vector<std::string> names{"nearest", "quad", "core", "rest"};
    for (size_t k = 0; k < names.size(); ++k)
        if (names[k] == name) return Interpolation(k);
    throw Misuse("interpolation: found '" + name + "', allowed nearest, quad, core, rest" +
                 did_you_mean(name, names));
}

Interpolator::Interpolator(Interpolation kind, Stencil stencil, const Groom& high, const Groom& low,
                           const Strands* shape, bool low_is_wet, const Settled* settled)
    : kind_(kind), stencil_(std::move(stencil)), roots_(root_frames(high)) {
    if (kind_ == Interpolation::core) cores_ = Strands(low.rest.count, low.rest.particles);
    if (kind_ == Interpolation::rest) carrier_.emplace(stencil_, high, low, shape, low_is_wet, settled);
}

// root + sum_k weight_k (strand_k - its root), for `n` particles.
static void weighted_mean(const Strands& strands, const int* from, const float* weight, int width,
                          const Vec3f& root, Vec3f* out) {
    std::fill_n(out, strands.particles, root);
    for (int k = 0; k < width; ++k) {
        if (weight[k] == 0) continue;
        const Vec3f* p = strands.strand(from[k]);
        for (int i = 1; i < strands.particles; ++i) out[i] += weight[k] * (p[i] - p[0]);
    }
}

// Adds to the core `out` the detail of strand p around its own core.
static void add_detail(const Vec3f* p, const Vec3f* core, int n, Vec3f* out) {
    CarriedTurn<float> turn;
    // In this order edge i of `out` is still bare core when particle i asks for it; the tip takes the last
    // one's.
    for (int i = 0; i < n; ++i) {
        if (i + 1 < n) turn.follow(core[i + 1] - core[i], out[i + 1] - out[i]);
        out[i] += rotate(turn.turn, p[i] - core[i]);
    }
}

void Interpolator::apply(const Strands& low, const Pose& head, Strands& out) {
    const int n = low.particles, width = stencil_.width;
    if (low.count != int(stencil_.twin.size()))
        throw Error("interpolation: found " + std::to_string(low.count) +
                    " low-resolution strands, allowed " + std::to_string(stencil_.twin.size()));
    if (out.count != stencil_.count() || out.particles != n) out = Strands(stencil_.count(), n);
    if (kind_ == Interpolation::rest) {
        carrier_->apply(low, head, out);
        place_in_world(roots_, out, head, out);
        return;
    }
    if (cores_.count) take_cores(low, cores_);
#pragma omp parallel for schedule(static)
    for (int s = 0; s < out.count; ++s) {
        const int nearest = stencil_.nearest[size_t(s)];
        const int* from = stencil_.from.data() + size_t(s) * width;
        const float* weight = stencil_.weight.data() + size_t(s) * width;
        const Vec3f root = roots_.root_at(s, head);
        const float one = 1;
        switch (kind_) {
            case Interpolation::nearest:
                weighted_mean(low, &nearest, &one, 1, root, out.strand(s));
                break;
            case Interpolation::quad:
                weighted_mean(low, from, weight, width, root, out.strand(s));
                break;
            default:
                weighted_mean(cores_, from, weight, width, root, out.strand(s));
                add_detail(low.strand(nearest), cores_.strand(nearest), n, out.strand(s));
        }
    }
}

}  // namespace wetcurl
