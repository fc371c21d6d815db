// The cohesion pass on the CPU: a cluster of particles and four neighbours at a time.
#include "solver/cohesion/cohesion_pass.h"

#include <omp.h>

#include <algorithm>
#include <cstring>

#include "base/geometry/filter.h"

namespace wetcurl {

using S = Pack<float>;

CohesionPass::CohesionPass(const Cohesion& term, int strands, const Thinning& thinning,
                           const std::vector<float>& volume, const std::vector<float>& saturation)
    : term_(term),
      thinning_(thinning),
      strands_(strands),
      particles_(thinning.count),
      water_(thinning.is_whole() ? std::nullopt
                                 : std::optional<ThinnedWater>({thinning, volume, saturation})),
      own_volume_(water_ ? water_->own_volume : volume),
      volume_(water_ ? water_->volume : volume),
      saturation_(water_ ? water_->saturation : saturation) {
    const size_t count = size_t(strands) * size_t(particles_), padded = count + NeighborList::padding;
    sums_.resize(padded), sorted_wet_volume_.resize(padded);
    rank_.resize(count);
    segment_.resize(size_t(strands)), own_weight_.resize(size_t(strands));
    if (thinning.every > 1) thinned_ = Strands(strands, particles_);
}

void CohesionPass::build_lists(const Strands& p, const Strands& whole) {
    const double begin = omp_get_wtime();
    const float radius = float(term_.h_c);
    grid_.build(p.points.data(), p.points.size(), radius, thinning_.seen < 1 ? &volume_ : nullptr);
    const long count = long(grid_.size());
#pragma omp parallel
    {
#pragma omp for schedule(static) nowait
        for (int s = 0; s < strands_; ++s) {
            segment_[size_t(s)] = float(arc_length(p.strand(s), particles_) / (particles_ - 1));
            own_weight_[size_t(s)] = float(term_.own_weight(
                thinning_.every == 1 ? segment_[size_t(s)]
                                     : arc_length(whole.strand(s), whole.particles) / (whole.particles - 1)));
        }
#pragma omp for schedule(static)
        for (long k = 0; k < count; ++k) {
            const size_t at = size_t(k), id = grid_.order()[at];
            grid_.points().set_group(at, uint32_t(id) / uint32_t(particles_));
            sorted_wet_volume_[at] = saturation_[id] * volume_[id];
            rank_[id] = uint32_t(k);
        }
    }
    list_.build(grid_, sorted_wet_volume_, radius);
#pragma omp parallel for schedule(static)
    for (long k = 0; k < count; ++k) grid_.points().number(size_t(k)) = volume_[grid_.order()[size_t(k)]];
    list_seconds_ = omp_get_wtime() - begin;
}

[[gnu::always_inline]] inline void CohesionPass::add_up(size_t c) {
    const size_t first = c * NeighborList::cluster;
    const PointQuads& points = grid_.points();
    const Vec3<S> own = points.a_quad_each(first);
    const S h(float(term_.h_c)), zero(0);
    Cohesion::Sums<S> sums{{zero, zero, zero}, zero};
    list_.visit_runs(c, [&](size_t four, uint32_t bits) {
        sums.add(points.in_each_quad(four) - own, h, points.numbers_in_each_quad(four, bits),
                 in_each_quad(&sorted_wet_volume_[4 * four], bits));
    });
    const S all = sums_of_quads(sums.pull.x, sums.pull.y, sums.pull.z, sums.weight);
    static_assert(sizeof all == NeighborList::cluster * sizeof sums_[0]);
    std::memcpy(&sums_[first], &all, sizeof all);
}

void CohesionPass::draw_together(const Strands& p) {
    if (thinning_.every > 1) {
#pragma omp parallel for schedule(static)
        for (int s = 0; s < strands_; ++s)
            for (int j = 0; j < particles_; ++j) thinned_.at(s, j) = p.at(s, thinning_.at(s, j));
    }
    build_lists(thinning_.every > 1 ? thinned_ : p, p);
    const long clusters = long(list_.clusters());
    for (int sweep = 0; sweep < term_.sweeps(); ++sweep) {
#pragma omp parallel for schedule(dynamic, 256)
        for (long c = 0; c < clusters; ++c) add_up(size_t(c));
        move_strands(term_.of_sweep(sweep));
    }
}

void CohesionPass::show(int strand, Vec3f* x, float* edges) const {
    const PointQuads& now = grid_.points();
    const uint32_t* rank = &rank_[size_t(strand) * size_t(particles_)];
    auto moved = [&](int j) { return now.at(rank[j]) - thinned_.at(strand, j); };
    Vec3f before = x[0];
    edges[0] = 0;
    for (int i = 1; i < thinning_.particles; ++i) {
        Vec3f end;
        if (thinning_.every == 1) {
            end = now.at(rank[i]);
        } else {
            const Thinning::Place at = thinning_.place(strand, i);
            end = x[i] + ((1 - at.after) * moved(at.before) + at.after * moved(at.before + 1));
        }
        edges[i] = norm(x[i] - before);
        before = x[i];
        x[i] = term_.within_length(x[i - 1], end, edges[i]);
    }
}

// By the pass at hand, smoothed: exponentially along each strand, tip and back, twice. A root does not move.
void CohesionPass::move_strands(const Cohesion& sweep) {
    const size_t n = size_t(particles_);
    PointQuads& now = grid_.points();
    moved_.resize(size_t(omp_get_max_threads()));
#pragma omp parallel
    {
        std::vector<Moved>& u = moved_[size_t(omp_get_thread_num())];
        u.resize(n);
#pragma omp for schedule(static)
        for (int block = 0; block < strands_; block += S::lanes) {
            const int lanes = std::min(S::lanes, strands_ - block);
            S beta(1), own_weight(1);
            for (int lane = 0; lane < lanes; ++lane) {
                const size_t s = size_t(block + lane);
                if (term_.coherence > 0) beta.set(lane, float(filter_beta(segment_[s], term_.coherence)));
                own_weight.set(lane, own_weight_[s]);
                for (size_t i = 1; i < n; ++i) {
                    const size_t k = rank_[s * n + i];
                    // Two lines anywhere: those of the strand after are asked for a strand ahead.
                    if (s + 1 < size_t(strands_)) {
                        const size_t next = rank_[(s + 1) * n + i];
                        __builtin_prefetch(&sums_[next]), __builtin_prefetch(&now.number(next), 1);
                    }
                    const Cohesion::Sums<float>& of = sums_[k];
                    u[i].by.x.set(lane, of.pull.x), u[i].by.y.set(lane, of.pull.y);
                    u[i].by.z.set(lane, of.pull.z), u[i].weight.set(lane, of.weight);
                    u[i].own.set(lane, own_volume_[s * n + i]);
                }
            }
            u[0].by = cast<S>(Vec3f{0, 0, 0});
            for (size_t i = 1; i < n; ++i)
                u[i].by = sweep.displacement(Cohesion::Sums<S>{u[i].by, u[i].weight}, u[i].own * own_weight);
            auto by = [&](int i) -> Vec3<S>& { return u[size_t(i)].by; };
            if (term_.coherence > 0) smooth_along(particles_, beta, by);
            for (int lane = 0; lane < lanes; ++lane) {
                const uint32_t* rank = &rank_[size_t(block + lane) * n];
                for (size_t i = 1; i < n; ++i) {
                    const Vec3<S>& by = u[i].by;
                    now.set(rank[i], now.at(rank[i]) + Vec3f{by.x[lane], by.y[lane], by.z[lane]});
                }
            }
        }
    }
}

size_t CohesionPass::bytes() const {
    const size_t floats = sorted_wet_volume_.capacity() + segment_.capacity() + own_weight_.capacity();
    const size_t thinned = water_ ? 3 * water_->volume.capacity() * sizeof(float) : 0;
    return thinned + thinned_.points.capacity() * sizeof(Vec3f) + floats * sizeof(float) +
           rank_.capacity() * sizeof(uint32_t) + sums_.capacity() * sizeof sums_[0] +
           moved_.size() * size_t(particles_) * sizeof(Moved) +
           edges_.size() * size_t(thinning_.particles) * sizeof(float) + grid_.bytes() + list_.bytes();
}

}  // namespace wetcurl
