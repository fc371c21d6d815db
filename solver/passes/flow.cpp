// The flow of water on the CPU.
#include "solver/passes/flow.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "solver/rest_state.h"

namespace wetcurl {

FlowPass::FlowPass(const Flow& flow, const Strands& rest, double density, double absorbed,
                   const std::vector<float>& saturation)
    : flow_(flow),
      strands_(rest.count),
      n_(rest.particles),
      density_(density),
      absorbed_(absorbed),
      next_(rest.points.size()),
      length_(rest.points.size()),
      limit_(rest.points.size()),
      shown_(rest.points.size()) {
    // Where segments have no length there is next to no hair, but no division by nothing.
    for (int s = 0; s < strands_; ++s) {
        const auto p = points_of(rest, s);
        for (double m : dry_masses(p, density)) mass_.push_back(std::max(m, 1e-30));
        for (int i = 0; i + 1 < n_; ++i)
            length_[at(s, i)] = std::max(norm(p[size_t(i) + 1] - p[size_t(i)]), 1e-9);
    }
    restore({saturation.begin(), saturation.end()});
}

void FlowPass::restore(const std::vector<double>& saturation) {
    sigma_ = saturation;
    ledger_.assign(size_t(strands_), Ledger{});
    start_ = held();
    show();
}

void FlowPass::show() { std::copy(sigma_.begin(), sigma_.end(), shown_.begin()); }

double FlowPass::held() const {
    double sum = 0;
    for (size_t k = 0; k < sigma_.size(); ++k) sum += mass_[k] * sigma_[k];
    return sum;
}

WaterBalance FlowPass::water() const {
    WaterBalance out{absorbed_ * start_, absorbed_ * held(), 0, 0, 0};
    for (const auto& l : ledger_)
        out.taken += absorbed_ * l.taken, out.dripped += absorbed_ * l.dripped,
            out.dried += absorbed_ * l.dried;
    return out;
}

// What a particle cannot hold hangs from it as a drop, and falls. Rounding below zero is made up for too.
void FlowPass::shed_excess(int s, double* sigma) {
    for (int i = 0; i < n_; ++i) {
        const double kept = std::clamp(sigma[i], 0.0, 1.0);
        ledger_[size_t(s)].dripped += mass_[at(s, i)] * (sigma[i] - kept);
        sigma[i] = kept;
    }
}

void FlowPass::wet(const Strands& p, double time, double dt) {
    for (const auto& source : flow_.sources) {
        if (!source.flows_at(time)) continue;
        const Pose pose = source.motion.at(time);
        const double taken = -std::expm1(-source.rate * dt);
#pragma omp parallel for schedule(static)
        for (int s = 0; s < strands_; ++s)
            for (int i = 0; i < n_; ++i) {
                const size_t k = at(s, i);
                if (!source.holds(cast<double>(p.points[k]), pose)) continue;
                const double before = sigma_[k];
                sigma_[k] = std::min(1.0, before + taken * (1 - before));
                ledger_[size_t(s)].taken += mass_[k] * (sigma_[k] - before);
            }
    }
}

// Backward Euler with the mobilities of the step before: (m + rates out) sigma = m sigma_before + rates in.
// Columns sum to m, so that no water is lost; eliminated from the root without a subtraction (Grassmann,
// Taksar and Heyman 1985), so that this holds to rounding and nothing is negative at any step.
void FlowPass::run_along_strand(int s, const Vec3f* x, double dt, const Vec3d& down, Rows& rows) {
    const double *m = &mass_[at(s, 0)], *length = &length_[at(s, 0)];
    double* sigma = &sigma_[at(s, 0)];
    const size_t tip = size_t(n_) - 1;
    double fall = 0, kept_before = 0;
    for (size_t i = 0; i <= tip; ++i) {
        double kept = m[i];  // the pivot without the flow to the next row
        rows.right[i] = m[i] * sigma[i];
        if (i > 0) {
            kept += rows.back[i - 1] * kept_before / rows.pivot[i - 1];
            rows.right[i] += rows.on[i - 1] * rows.right[i - 1];
        }
        Flow::Rates rates{0, 0};
        if (i < tip) {
            const Vec3d e = cast<double>(x[i + 1]) - cast<double>(x[i]);
            fall = dot(normalized(e, Vec3d{0, 0, 0}), down);
            rates = flow_.edge_rates(sigma[i], sigma[i + 1], fall, length[i], density_);
        } else {
            rates.down = flow_.tip_rate(sigma[i], fall, density_);
        }
        rows.pivot[i] = kept + dt * rates.down;
        rows.on[i] = dt * rates.down / rows.pivot[i];
        rows.back[i] = dt * rates.up;
        kept_before = kept;
    }
    for (size_t i = tip + 1; i-- > 0;)
        sigma[i] = (rows.right[i] + (i < tip ? rows.back[i] * sigma[i + 1] : 0)) / rows.pivot[i];
    ledger_[size_t(s)].dripped += rows.on[tip] * rows.right[tip];
    shed_excess(s, sigma);
}

void FlowPass::run_along(const Strands& p, double dt, const Vec3d& gravity) {
    const Vec3d down = (1 / 9.81) * gravity;
#pragma omp parallel
    {
        Rows rows{size_t(n_)};
#pragma omp for schedule(static)
        for (int s = 0; s < strands_; ++s) {
            const double shortest = *std::min_element(&length_[at(s, 0)], &length_[at(s, n_ - 1)]);
            const int steps = flow_.substeps(dt, shortest);
            for (int k = 0; k < steps; ++k) run_along_strand(s, p.strand(s), dt / steps, down, rows);
        }
    }
}

void FlowPass::search(const Strands& p) {
    const size_t count = p.points.size(), padded = count + NeighborList::lanes;
    grid_.build(p.points.data(), count, float(flow_.reach));
    strand_.resize(padded), any_source_.assign(padded, 1.f);
    for (size_t k = 0; k < count; ++k) strand_[k] = grid_.order()[k] / uint32_t(n_);
    list_.build(grid_, strand_, any_source_, float(flow_.reach));
}

// Fluxes g_ij (sigma_j - sigma_i), the same number with the other sign on the other side. Where a particle's
// neighbours together would take more than it has, its fluxes are scaled down, and with them theirs: every
// new saturation is a mean of old ones.
void FlowPass::exchange(double dt, const NeighborGrid& grid, const NeighborList& list) {
    using S = Pack<float>;
    const auto& id = grid.order();
    const PointArrays& x = grid.points();
    const S square(float(flow_.reach * flow_.reach));
    auto for_each_contact = [&](size_t k, auto visit) {
        const Vec3<S> own = cast<S>(x.at(k));
        list.visit_runs(k, [&](uint32_t first, uint32_t bits) {
            // The lists may hold neighbours much further away.
            const Vec3<S> d = x.load(first) - own;
            const S r = dot(d, d);
            for (bits &= bits_of(r < square); bits; bits &= bits - 1) {
                const int lane = std::countr_zero(bits);
                const size_t j = id[first + uint32_t(lane)];
                visit(j, flow_.passed(mass_[id[k]], mass_[j], std::sqrt(double(r[lane])), dt));
            }
        });
    };
    const long count = long(grid.size());
#pragma omp parallel for schedule(static)
    for (long k = 0; k < count; ++k) {
        const size_t i = id[size_t(k)];
        double sum = 0;
        for_each_contact(size_t(k), [&](size_t, double g) { sum += g; });
        limit_[i] = sum > mass_[i] ? mass_[i] / sum : 1;
    }
#pragma omp parallel for schedule(static)
    for (long k = 0; k < count; ++k) {
        const size_t i = id[size_t(k)];
        double sum = 0;
        for_each_contact(size_t(k), [&](size_t j, double g) {
            sum += g * std::min(limit_[i], limit_[j]) * (sigma_[j] - sigma_[i]);
        });
        next_[i] = sigma_[i] + sum / mass_[i];
    }
    if (count) std::swap(sigma_, next_);
#pragma omp parallel for schedule(static)
    for (int s = 0; s < strands_; ++s) shed_excess(s, &sigma_[at(s, 0)]);
}

void FlowPass::dry(double dt) {
    const double share = -std::expm1(-flow_.drying * dt);
#pragma omp parallel for schedule(static)
    for (int s = 0; s < strands_; ++s)
        for (size_t k = at(s, 0); k < at(s + 1, 0); ++k) {
            const double before = sigma_[k];
            sigma_[k] -= share * before;
            ledger_[size_t(s)].dried += mass_[k] * (before - sigma_[k]);
        }
}

void FlowPass::step(const Strands& p, double time, double dt, const Vec3d& gravity, const NeighborGrid* grid,
                    const NeighborList* list) {
    wet(p, time, dt);
    run_along(p, dt, gravity);
    if (!grid) search(p), grid = &grid_, list = &list_;
    exchange(dt, *grid, *list);
    dry(dt);
    show();
}

size_t FlowPass::bytes() const {
    const size_t doubles = sigma_.capacity() + next_.capacity() + mass_.capacity() + length_.capacity() +
                           limit_.capacity() + 3 * ledger_.capacity();
    return doubles * sizeof(double) + (shown_.capacity() + any_source_.capacity()) * sizeof(float) +
           strand_.capacity() * sizeof(uint32_t) + grid_.bytes() + list_.bytes();
}

}  // namespace wetcurl
