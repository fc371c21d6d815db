// What water does along one strand and at one particle: the bodies of the flow's loops, on any device.
#pragma once

#include <vector>

#include "base/strands.h"
#include "solver/terms/flow.h"

namespace wetcurl {

struct Scene;

// Of one strand, in masses of the hair that holds as much.
struct FlowLedger {
    double taken = 0, dripped = 0, dried = 0;
};
// Water of all strands [kg]. What was held at the start and what was taken is now held, dripped or dried.
struct WaterBalance {
    double start = 0, held = 0, taken = 0, dripped = 0, dried = 0;
    double balance() const { return held + dripped + dried - taken - start; }
    std::vector<double> columns() const { return {held, taken, dripped, dried}; }  // of RunFrame::water
};

// Of what strands' ledgers say, `start` and `held` masses as in them; `absorbed`: m_absorbed.
WaterBalance water_balance(double absorbed, double start, double held, const std::vector<FlowLedger>& ledger);

// The ledgers and what was held at the start as numbers, and back.
std::vector<double> carried_of(double start, const std::vector<FlowLedger>& ledger);
double take_carried(const std::vector<double>& carried, std::vector<FlowLedger>& ledger);

// What the flow needs of strands whose segments keep their length.
struct FlowHair {
    int strands, particles;
    double density;                    // [kg/m] of a dry strand, alike for all
    std::vector<double> mass, length;  // (strand, particle) dry [kg], [m] to the next
    // The mean density of a scene's fibres conducts; each has the mass of its own thickness.
    explicit FlowHair(const Scene& scene);
    FlowHair(const Strands& rest, double density);

  private:
    void add(const std::vector<double>& masses, const std::vector<Vec3d>& p);
};

// Of the elimination along a strand: how much the edge falls, the row's right side, what of it goes on to the
// next row, what comes back from there, and the pivot.
struct FlowRow {
    double fall, right, on, back, pivot;
};

// Of `count` particles.
WETCURL_HD inline double water_held(const double* mass, const double* sigma, size_t count) {
    double sum = 0;
    for (size_t k = 0; k < count; ++k) sum += mass[k] * sigma[k];
    return sum;
}

// A view of the flow's arrays.
struct FlowKernelBody {
    FlowRules rules;
    double density;                // mu [kg/m]
    int n;                         // particles of a strand
    const double *mass, *length;   // (strand, particle) [kg], [m] to the next
    double *sigma, *next, *limit;  // (strand, particle)
    FlowLedger* ledger;            // (strand)

    WETCURL_HD size_t at(int s, int i) const { return size_t(s) * size_t(n) + size_t(i); }

    // x (strand, particle) [m].
    WETCURL_HD void wet(int s, const FlowingSource& source, const Vec3f* x) const {
        for (size_t k = at(s, 0); k < at(s + 1, 0); ++k) {
            if (!source.holds(cast<double>(x[k]))) continue;
            const double before = sigma[k];
            sigma[k] = source.wetted(before);
            ledger[s].taken += mass[k] * (sigma[k] - before);
        }
    }
    // sigma becomes `from`. What a particle cannot hold hangs from it as a drop, and falls. Rounding below
    // zero is made up for too.
    WETCURL_HD void shed_excess(int s, const double* from) const {
        for (size_t k = at(s, 0); k < at(s + 1, 0); ++k) {
            const double kept = minimum(maximum(from[k], 0.0), 1.0);
            ledger[s].dripped += mass[k] * (from[k] - kept);
            sigma[k] = kept;
        }
    }

    // dt [s] along a strand at x (strand, particle), `down`: g / |g_0|. `rows` (particle) is room for it.
    template <class Rows>
    WETCURL_HD void run_along(int s, const Vec3f* x, double dt, const Vec3d& down, const Rows& rows) const {
        double shortest = length[at(s, 0)], fall = 0;
        for (int i = 0; i + 1 < n; ++i) {
            const size_t k = at(s, i);
            shortest = minimum(length[k], shortest);
            const Vec3d e = cast<double>(x[k + 1]) - cast<double>(x[k]);
            rows[size_t(i)].fall = fall = dot(normalized(e, Vec3d{0, 0, 0}), down);
        }
        rows[size_t(n) - 1].fall = fall;
        const int steps = rules.substeps(dt, shortest);
        for (int k = 0; k < steps; ++k) step_along(s, dt / steps, rows);
    }
    // Backward Euler with the mobilities of the step before: (m + rates out) sigma = m sigma_before + rates
    // in. Columns sum to m, so that no water is lost; eliminated from the root without a subtraction
    // (Grassmann, Taksar and Heyman 1985), so that this holds to rounding and nothing is negative at any
    // step.
    template <class Rows>
    WETCURL_HD void step_along(int s, double dt, const Rows& rows) const {
        const double *m = mass + at(s, 0), *l = length + at(s, 0);
        double* const own = sigma + at(s, 0);
        const size_t tip = size_t(n) - 1;
        double kept_before = 0;
        FlowRow before{};
        for (size_t i = 0; i <= tip; ++i) {
            double kept = m[i];  // the pivot without the flow to the next row
            FlowRow row{rows[i].fall, m[i] * own[i], 0, 0, 0};
            if (i > 0) {
                kept += before.back * kept_before / before.pivot;
                row.right += before.on * before.right;
            }
            FlowRules::Rates rates{0, 0};
            if (i < tip)
                rates = rules.edge_rates(own[i], own[i + 1], row.fall, l[i], density);
            else
                rates.down = rules.tip_rate(own[i], row.fall, density);
            row.pivot = kept + dt * rates.down;
            row.on = dt * rates.down / row.pivot;
            row.back = dt * rates.up;
            kept_before = kept;
            rows[i] = before = row;
        }
        ledger[s].dripped += before.on * before.right;
        for (size_t i = tip + 1; i-- > 0;) {
            const FlowRow row = rows[i];
            own[i] = (row.right + (i < tip ? row.back * own[i + 1] : 0)) / row.pivot;
        }
        shed_excess(s, sigma);
    }

    // Fluxes g_ij (sigma_j - sigma_i) within dt [s], the same number with the other sign on the other side.
    // Where a particle's neighbours together would take more than it has, its fluxes are scaled down, and
    // with them theirs: every new saturation is a mean of old ones. `for_each_contact` calls visit(j, r) for
    // each particle j of another strand within reach, r [m] away. First all limits, then all passes.
    template <class Contacts>
    WETCURL_HD void find_limit(size_t i, double dt, Contacts for_each_contact) const {
        double sum = 0;
        for_each_contact([&](size_t j, double r) { sum += rules.passed(mass[i], mass[j], r, dt); });
        limit[i] = sum > mass[i] ? mass[i] / sum : 1;
    }
    template <class Contacts>
    WETCURL_HD void pass_on(size_t i, double dt, Contacts for_each_contact) const {
        double sum = 0;
        for_each_contact([&](size_t j, double r) {
            sum +=
                rules.passed(mass[i], mass[j], r, dt) * minimum(limit[i], limit[j]) * (sigma[j] - sigma[i]);
        });
        next[i] = sigma[i] + sum / mass[i];
    }

    // `share` of the water of strand s.
    WETCURL_HD void dry(int s, double share) const {
        for (size_t k = at(s, 0); k < at(s + 1, 0); ++k) {
            const double before = sigma[k];
            sigma[k] -= share * before;
            ledger[s].dried += mass[k] * (before - sigma[k]);
        }
    }
};

}  // namespace wetcurl
