// The cohesion pass on the CPU.
#include "solver/passes/cohesion.h"

#include <omp.h>

#include "base/geometry/filter.h"

namespace wetcurl {

CohesionPass::CohesionPass(const Cohesion& term, int strands, int particles, const std::vector<float>& volume,
                           const std::vector<float>& saturation)
    : term_(term), particles_(particles), volume_(volume), saturation_(saturation) {
    const size_t count = size_t(strands) * size_t(particles);
    sorted_.resize(count);
    next_.resize(count);
    start_.resize(count + 1);
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
    start_[0] = 0;
#pragma omp parallel for schedule(dynamic, 512)
    for (long k = 0; k < count; ++k) {
        uint32_t found = 0;
        neighbours(k, [&](uint32_t) { ++found; });
        start_[size_t(k) + 1] = found;
    }
    for (long k = 0; k < count; ++k) start_[size_t(k) + 1] += start_[size_t(k)];
    list_.resize(start_.back());
#pragma omp parallel for schedule(dynamic, 512)
    for (long k = 0; k < count; ++k) {
        uint32_t* out = list_.data() + start_[size_t(k)];
        neighbours(k, [&](uint32_t j) { *out++ = j; });
        sorted_[size_t(k)] = {points[size_t(k)], volume_[order[size_t(k)]], saturation_[order[size_t(k)]]};
    }
    next_ = sorted_;
    list_seconds_ = omp_get_wtime() - begin;
}

void CohesionPass::apply(const Strands& p, Strands& displayed) {
    build_lists(p);
    const auto& order = grid_.order();
    const float h = float(term_.h_c);
    const long count = long(sorted_.size());
    for (int pass = 0; pass < term_.passes; ++pass) {
#pragma omp parallel for schedule(dynamic, 1024)
        for (long k = 0; k < count; ++k) {
            if (order[size_t(k)] % uint32_t(particles_) == 0) continue;
            const Particle& own = sorted_[size_t(k)];
            Cohesion::Sums<float> sums;
            for (uint32_t at = start_[size_t(k)]; at < start_[size_t(k) + 1]; ++at) {
                const Particle& other = sorted_[list_[at]];
                sums.add(other.p - own.p, h, other.volume, other.saturation);
            }
            next_[size_t(k)].p = own.p + term_.displacement(sums, own.volume);
        }
        if (term_.coherence > 0) smooth_displacements(p);
        std::swap(sorted_, next_);
    }
    displayed = Strands(p.count, p.particles);
    for (long k = 0; k < count; ++k) displayed.points[order[size_t(k)]] = sorted_[size_t(k)].p;
}

// Of the pass at hand: exponential smoothing along each strand, tip and back, twice; a root does not move.
void CohesionPass::smooth_displacements(const Strands& p) {
    const int n = p.particles;
    rank_.resize(sorted_.size());
    for (size_t k = 0; k < rank_.size(); ++k) rank_[grid_.order()[k]] = uint32_t(k);
#pragma omp parallel
    {
        std::vector<Vec3f> u(static_cast<size_t>(n));
#pragma omp for schedule(static)
        for (int s = 0; s < p.count; ++s) {
            const uint32_t* rank = rank_.data() + size_t(s) * size_t(n);
            const float beta = float(filter_beta(arc_length(p.strand(s), n) / (n - 1), term_.coherence));
            for (size_t i = 0; i < u.size(); ++i) u[i] = next_[rank[i]].p - sorted_[rank[i]].p;
            for (int round = 0; round < 2; ++round) {
                for (size_t i = 1; i < u.size(); ++i) u[i] = u[i - 1] + beta * (u[i] - u[i - 1]);
                for (size_t i = u.size() - 2; i > 0; --i) u[i] = u[i + 1] + beta * (u[i] - u[i + 1]);
            }
            for (size_t i = 1; i < u.size(); ++i) next_[rank[i]].p = sorted_[rank[i]].p + u[i];
        }
    }
}

size_t CohesionPass::bytes() const {
    return (sorted_.capacity() + next_.capacity()) * sizeof(Particle) + (start_.capacity() + list_.capacity() + rank_.capacity()) * sizeof(uint32_t) +
           grid_.bytes();
}

}  // namespace wetcurl
