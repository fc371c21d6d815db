// The cohesion pass on the CPU: a vector of neighbours at a time.
#include "solver/passes/cohesion.h"

#include <omp.h>

#include "base/geometry/filter.h"

namespace wetcurl {

static constexpr uint32_t lanes = Pack<float>::lanes;

CohesionPass::CohesionPass(const Cohesion& term, int strands, int particles, const std::vector<float>& volume,
                           const std::vector<float>& saturation)
    : term_(term), particles_(particles), volume_(volume), saturation_(saturation) {
    const size_t count = size_t(strands) * size_t(particles);
    now_.resize(count + 1), next_.resize(count + 1);
    sorted_volume_.assign(count + 1, 0.f), sorted_saturation_.assign(count + 1, 0.f);
    start_.resize(count + 1), rank_.resize(count);
    segment_.resize(size_t(strands)), own_weight_.resize(size_t(strands));
}

void CohesionPass::build_lists(const Strands& p) {
    const double begin = omp_get_wtime();
    const float h = float(term_.h_c);
    grid_.build(p.points.data(), p.points.size(), h);
    const auto& order = grid_.order();
    const auto& points = grid_.sorted();
    const long count = long(points.size());
    auto neighbours = [&](long k, auto visit) {
        const uint32_t strand = order[size_t(k)] / uint32_t(particles_);
        const Vec3f x = points[size_t(k)];
        grid_.around(x, [&](uint32_t j) {
            const Vec3f d = points[j] - x;
            if (dot(d, d) < h * h && order[j] / uint32_t(particles_) != strand) visit(j);
        });
    };
#pragma omp parallel for schedule(static)
    for (int s = 0; s < p.count; ++s) {
        segment_[size_t(s)] = float(arc_length(p.strand(s), p.particles) / (p.particles - 1));
        own_weight_[size_t(s)] = float(term_.own_weight(segment_[size_t(s)]));
    }
    start_[0] = 0;
#pragma omp parallel for schedule(dynamic, 512)
    for (long k = 0; k < count; ++k) {
        uint32_t found = 0;
        neighbours(k, [&](uint32_t) { ++found; });
        start_[size_t(k) + 1] = found;
    }
    for (long k = 0; k < count; ++k) start_[size_t(k) + 1] += start_[size_t(k)];
    const size_t needed = start_.back() + lanes;  // the last vector may read beyond its list
    if (needed > list_.capacity()) {
        // A tenth of slack: growing by doubling would double the largest buffer of all.
        list_ = {};
        list_.reserve(needed + needed / 10);
    }
    list_.resize(needed);
#pragma omp parallel for schedule(dynamic, 512)
    for (long k = 0; k < count; ++k) {
        const size_t at = size_t(k), id = order[at];
        uint32_t* out = list_.data() + start_[at];
        neighbours(k, [&](uint32_t j) { *out++ = j; });
        now_.set(at, points[at]);
        next_.set(at, points[at]);
        sorted_volume_[at] = volume_[id];
        sorted_saturation_[at] = saturation_[id];
        rank_[id] = uint32_t(k);
    }
    list_seconds_ = omp_get_wtime() - begin;
}

static Pack<float> gathered(const std::vector<float>& from, const uint32_t* index) {
    Pack<float> out;
    for (uint32_t l = 0; l < lanes; ++l) out.v[l] = from[index[l]];
    return out;
}

static float sum(const Pack<float>& a) {
    float s = 0;
    for (uint32_t l = 0; l < lanes; ++l) s += a.v[l];
    return s;
}

Vec3f CohesionPass::displacement(size_t k) const {
    using S = Pack<float>;
    const Vec3<S> own = cast<S>(now_.at(k));
    const S h(float(term_.h_c));
    const uint32_t nobody = uint32_t(rank_.size()), end = start_[k + 1];
    Cohesion::Sums<S> sums{{S(0), S(0), S(0)}, S(0)};
    for (uint32_t at = start_[k]; at < end; at += lanes) {
        alignas(64) uint32_t index[lanes];
        for (uint32_t l = 0; l < lanes; ++l) index[l] = at + l < end ? list_[at + l] : nobody;
        const Vec3<S> other{gathered(now_.x, index), gathered(now_.y, index), gathered(now_.z, index)};
        sums.add(other - own, h, gathered(sorted_volume_, index), gathered(sorted_saturation_, index));
    }
    const Cohesion::Sums<float> total{{sum(sums.pull.x), sum(sums.pull.y), sum(sums.pull.z)},
                                      sum(sums.weight)};
    const size_t strand = grid_.order()[k] / size_t(particles_);
    return term_.displacement(total, sorted_volume_[k] * own_weight_[strand]);
}

void CohesionPass::apply(const Strands& p, Strands& displayed) {
    build_lists(p);
    const auto& order = grid_.order();
    const long count = long(order.size());
    for (int pass = 0; pass < term_.passes; ++pass) {
#pragma omp parallel for schedule(dynamic, 1024)
        for (long k = 0; k < count; ++k)
            if (order[size_t(k)] % uint32_t(particles_) != 0)
                next_.set(size_t(k), now_.at(size_t(k)) + displacement(size_t(k)));
        if (term_.coherence > 0) smooth_displacements(p);
        std::swap(now_, next_);
    }
    displayed = Strands(p.count, p.particles);
    for (long k = 0; k < count; ++k) displayed.points[order[size_t(k)]] = now_.at(size_t(k));
}

// Of the pass at hand: exponential smoothing along each strand, tip and back, twice; a root does not move.
void CohesionPass::smooth_displacements(const Strands& p) {
    const int n = p.particles;
#pragma omp parallel
    {
        std::vector<Vec3f> u(static_cast<size_t>(n));
#pragma omp for schedule(static)
        for (int s = 0; s < p.count; ++s) {
            const uint32_t* rank = rank_.data() + size_t(s) * size_t(n);
            const float beta = float(filter_beta(segment_[size_t(s)], term_.coherence));
            for (size_t i = 0; i < u.size(); ++i) u[i] = next_.at(rank[i]) - now_.at(rank[i]);
            for (int round = 0; round < 2; ++round) {
                for (size_t i = 1; i < u.size(); ++i) u[i] = u[i - 1] + beta * (u[i] - u[i - 1]);
                for (size_t i = u.size() - 2; i > 0; --i) u[i] = u[i + 1] + beta * (u[i] - u[i + 1]);
            }
            for (size_t i = 1; i < u.size(); ++i) next_.set(rank[i], now_.at(rank[i]) + u[i]);
        }
    }
}

size_t CohesionPass::bytes() const {
    const size_t floats = 3 * (now_.x.capacity() + next_.x.capacity()) + sorted_volume_.capacity() +
                          sorted_saturation_.capacity() + segment_.capacity() + own_weight_.capacity();
    const size_t indices = start_.capacity() + list_.capacity() + rank_.capacity();
    return floats * sizeof(float) + indices * sizeof(uint32_t) + grid_.bytes();
}

}  // namespace wetcurl
