// What low-resolution strands carry to the new roots.
#include "learn/codec/interpolate.h"

#include <algorithm>

#include "base/error.h"
#include "base/pack_tile.h"
#include "learn/codec/core_detail.h"

namespace wetcurl {

Interpolation interpolation_named(const std::string& name) {
    static const std::vector<std::string> names{"nearest", "quad", "core", "rest", "skin"};
    for (size_t k = 0; k < names.size(); ++k)
        if (names[k] == name) return Interpolation(k);
    throw Misuse("interpolation: found '" + name + "', allowed nearest, quad, core, rest, skin" +
                 did_you_mean(name, names));
}

void require_low_strands(int found, int found_particles, int strands, int particles) {
    if (found != strands || found_particles != particles)
        throw Error("interpolation: found " + std::to_string(found) + " low-resolution strands of " +
                    std::to_string(found_particles) + " particles, allowed " + std::to_string(strands) +
                    " of " + std::to_string(particles));
}

Interpolator::Interpolator(Interpolation kind, Stencil stencil, const Groom& high, const Groom& low,
                           const Strands* shape, bool low_is_wet, const Settled* settled)
    : kind_(kind), particles_(high.rest.particles), stencil_(std::move(stencil)), roots_(root_frames(high)) {
    if (kind_ == Interpolation::skin) {
        rest_ = high.rest, low_rest_ = low.rest;
        turns_.resize(low.rest.points.size());
    }
    if (kind_ != Interpolation::core && kind_ != Interpolation::rest) return;
    RootLanes lanes(StrandLanes::in_order(high.rest.count), roots_);
    if (kind_ == Interpolation::rest) {
        carrier_.emplace(std::move(lanes), stencil_, high, low, shape, low_is_wet, settled);
    } else {
        lanes_.emplace(std::move(lanes));
        low_lanes_.emplace(StrandLanes::in_order(low.rest.count));
        cores_ = Strands(low.rest.count, low.rest.particles);
    }
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

void Interpolator::place_means(const Strands& low, const Pose& head, Strands& out) const {
    const float one = 1;
    const bool nearest = kind_ == Interpolation::nearest;
    const int width = nearest ? 1 : stencil_.width;
    const int* from = nearest ? stencil_.nearest.data() : stencil_.from.data();
#pragma omp parallel for schedule(static)
    for (int s = 0; s < out.count; ++s)
        weighted_mean(low, from + size_t(s) * width, nearest ? &one : &stencil_.weight[size_t(s) * width],
                      width, roots_.root_at(s, head), out.strand(s));
}

void Interpolator::place_cores(const Strands& low, const Pose& head, Strands& out) {
    const int n = low.particles, width = stencil_.width;
    room_.require(3 * size_t(n));
#pragma omp parallel
    {
        Vec3<S>*const p = room_.mine(), *const core = p + n, *const x = core + n;
#pragma omp for schedule(static)
        for (int block = 0; block < low_lanes_->blocks(); ++block) {
            low_lanes_->load(block, 3 * n, &low.points.data()->x, &p->x);
            core_of(p, n, core_beta(n), core);
            low_lanes_->store(block, 3 * n, &core->x, &cores_.points.data()->x);
        }
#pragma omp for schedule(static)
        for (int block = 0; block < lanes_->blocks(); ++block) {
            constexpr int most = Stencil::widest;
            const float *nearest[S::lanes], *nearest_core[S::lanes], *around[S::lanes * most];
            float weight[S::lanes * most], one[S::lanes];
            for (int lane = 0; lane < S::lanes; ++lane) {
                const size_t s = size_t(std::max(lanes_->strand(block, lane), 0));
                nearest[lane] = &low.strand(stencil_.nearest[s])->x;
                nearest_core[lane] = &cores_.strand(stencil_.nearest[s])->x;
                one[lane] = 1;
                for (int k = 0; k < width; ++k) {
                    around[lane * width + k] =
                        &cores_.strand(stencil_.from[s * size_t(width) + size_t(k)])->x;
                    weight[lane * width + k] = stencil_.weight[s * size_t(width) + size_t(k)];
                }
            }
            weighted_columns(3 * n, 1, nearest, one, &p->x);
            weighted_columns(3 * n, 1, nearest_core, one, &core->x);
            weighted_columns(3 * n, width, around, weight, &x->x);
            const Vec3<S> move = lanes_->root_at(block, head) - x[0];
            for (int i = 0; i < n; ++i) x[i] += move;
            // Particle i takes the turn of the edge that follows, the tip that of the last one: when edge i
            // is asked for, it is still bare core.
            CarriedTurn<S> turn;
            for (int i = 0; i < n; ++i) {
                if (i + 1 < n) turn.follow(core[i + 1] - core[i], x[i + 1] - x[i]);
                x[i] += rotate(turn.turn, p[i] - core[i]);
            }
            lanes_->store(block, 3 * n, &x->x, &out.points.data()->x);
        }
    }
}

void Interpolator::place_skin(const Strands& low, const Pose& head, Strands& out) {
    const int n = low.particles, width = stencil_.width;
    const Quatf turned = cast<float>(head.rotation);
#pragma omp parallel
    {
#pragma omp for schedule(static)
        for (int s = 0; s < low.count; ++s) {
            const Vec3f *rest = low_rest_.strand(s), *p = low.strand(s);
            CarriedTurn<float> turn{turned};
            for (int i = 0; i < n; ++i) {  // the tip takes the turn of the last edge
                if (i + 1 < n) turn.follow(rest[i + 1] - rest[i], p[i + 1] - p[i]);
                turns_[size_t(s) * n + i] = turn.turn;
            }
        }
#pragma omp for schedule(static)
        for (int s = 0; s < out.count; ++s) {
            const Vec3f* rest = rest_.strand(s);
            Vec3f* const x = out.strand(s);
            std::fill_n(x, n, Vec3f{0, 0, 0});
            for (int k = 0; k < width; ++k) {
                const int from = stencil_.from[size_t(s) * width + k];
                const float weight = stencil_.weight[size_t(s) * width + k];
                if (weight == 0) continue;
                const Vec3f *guide = low.strand(from), *at_rest = low_rest_.strand(from);
                for (int i = 1; i < n; ++i)
                    x[i] += weight * (guide[i] + rotate(turns_[size_t(from) * n + i], rest[i] - at_rest[i]));
            }
            x[0] = roots_.root_at(s, head);
        }
    }
}

void Interpolator::place_rest(const Strands& low, const Pose& head, Strands& out) {
    const int n = low.particles;
    const RootLanes& lanes = carrier_->lanes();
    room_.require(size_t(n));
#pragma omp parallel
    {
        carrier_->follow(low.points.data(), head);
        Vec3<S>* const x = room_.mine();
#pragma omp for schedule(static)
        for (int block = 0; block < lanes.blocks(); ++block) {
            carrier_->carry(block, x);
            const Quat<S> to_world = lanes.rotation_at(block, head);
            const Vec3<S> root = lanes.root_at(block, head);
            for (int i = 0; i < n; ++i) x[i] = root + rotate(to_world, x[i]);
            lanes.store(block, 3 * n, &x->x, &out.points.data()->x);
        }
    }
}

void Interpolator::apply(const Strands& low, const Pose& head, Strands& out) {
    const int n = low.particles;
    require_low_strands(low.count, n, int(stencil_.twin.size()), particles_);
    if (out.count != stencil_.count() || out.particles != n) out = Strands(stencil_.count(), n);
    if (kind_ == Interpolation::rest)
        place_rest(low, head, out);
    else if (kind_ == Interpolation::core)
        place_cores(low, head, out);
    else if (kind_ == Interpolation::skin)
        place_skin(low, head, out);
    else
        place_means(low, head, out);
}

}  // namespace wetcurl
