// V-cycles.
#include "solver/air/multigrid.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wetcurl {

namespace {

// Fewer rows of cells than this are not worth waking threads for.
constexpr int parallel_rows = 256;

// Over-relaxation that smooths best in three dimensions (Yavneh 1996).
constexpr double smoothing = 1.15;

}  // namespace

Multigrid::Multigrid(const std::array<int, 3>& cells, double cell) {
    auto [nx, ny, nz] = cells;
    for (;;) {
        const size_t padded = size_t(nx + 2) * size_t(ny + 2) * size_t(nz + 2);
        levels_.push_back(
            {nx, ny, nz, cell * cell, std::vector<double>(padded, 0.0), std::vector<double>(padded, 0.0)});
        if (nx % 2 || ny % 2 || nz % 2 || std::min({nx, ny, nz}) <= 2) break;
        nx /= 2, ny /= 2, nz /= 2, cell *= 2;
    }
}

// h² A p = (6 + s) p - sum of the neighbours: a neighbour outside is -p, which is zero on the face, and so
// counts in the cell's own row once for each of its s faces on the surface.
double Multigrid::Level::residual(int i, int j, int k) const {
    const size_t c = at(i, j, k), row = size_t(nx + 2), layer = row * size_t(ny + 2);
    const double sum = p[c - 1] + p[c + 1] + p[c - row] + p[c + row] + p[c - layer] + p[c + layer];
    const int faces = 6 + surfaces(j, k) + (i == 0) + (i == nx - 1);
    return b[c] - (faces * p[c] - sum) / h2;
}

void Multigrid::smooth(Level& l, double omega, int sweeps) {
    for (int half = 0; half < 2 * sweeps; ++half)
#pragma omp parallel for collapse(2) schedule(static) if (l.ny * l.nz >= parallel_rows)
        for (int k = 0; k < l.nz; ++k)
            for (int j = 0; j < l.ny; ++j) {
                // w r / a with r the residual and a the cell's own entry.
                const double w = omega * l.h2 / (6 + l.surfaces(j, k));
                const double w_end = omega * l.h2 / (6 + l.surfaces(j, k) + 1);
                const int first = (j + k + half) % 2, last = l.nx - 1;
                if (first == 0) l.p[l.at(0, j, k)] += w_end * l.residual(0, j, k);
                for (int i = first == 0 ? 2 : 1; i < last; i += 2)
                    l.p[l.at(i, j, k)] += w * l.residual(i, j, k);
                if (last % 2 == first) l.p[l.at(last, j, k)] += w_end * l.residual(last, j, k);
            }
}

void Multigrid::restrict_residual(const Level& fine, Level& coarse) {
#pragma omp parallel for collapse(2) schedule(static) if (coarse.ny * coarse.nz >= parallel_rows)
    for (int k = 0; k < coarse.nz; ++k)
        for (int j = 0; j < coarse.ny; ++j)
            for (int i = 0; i < coarse.nx; ++i) {
                double sum = 0;
                for (int kk = 2 * k; kk < 2 * k + 2; ++kk)
                    for (int jj = 2 * j; jj < 2 * j + 2; ++jj)
                        sum += fine.residual(2 * i, jj, kk) + fine.residual(2 * i + 1, jj, kk);
                coarse.b[coarse.at(i, j, k)] = sum / 8;
            }
}

namespace {

// The two coarse cells that a fine one lies between along an axis. Beyond the surface stands minus the last
// cell, so that the sum is zero on the face.
struct Between {
    int near, far;
    double near_weight, far_weight;
    Between(int fine, int coarse_cells) : near(fine / 2), far(fine % 2 ? near + 1 : near - 1) {
        const bool outside = far < 0 || far == coarse_cells;
        near_weight = outside ? 0.5 : 0.75, far_weight = outside ? 0 : 0.25;
    }
};

}  // namespace

void Multigrid::add_correction(const Level& coarse, Level& fine) {
#pragma omp parallel for collapse(2) schedule(static) if (fine.ny * fine.nz >= parallel_rows)
    for (int k = 0; k < fine.nz; ++k)
        for (int j = 0; j < fine.ny; ++j) {
            const Between z(k, coarse.nz), y(j, coarse.ny);
            auto column = [&](int i) {
                auto at = [&](int jj, int kk) { return coarse.p[coarse.at(i, jj, kk)]; };
                return z.near_weight *
                           (y.near_weight * at(y.near, z.near) + y.far_weight * at(y.far, z.near)) +
                       z.far_weight * (y.near_weight * at(y.near, z.far) + y.far_weight * at(y.far, z.far));
            };
            double before = -column(0), here = -before;
            for (int i = 0; i < coarse.nx; ++i) {
                const double after = i + 1 < coarse.nx ? column(i + 1) : -here;
                fine.p[fine.at(2 * i, j, k)] += 0.75 * here + 0.25 * before;
                fine.p[fine.at(2 * i + 1, j, k)] += 0.75 * here + 0.25 * after;
                before = here, here = after;
            }
        }
}

void Multigrid::v_cycle(size_t level) {
    Level& l = levels_[level];
    if (level + 1 == levels_.size()) {
        // Few cells: over-relaxed as suits the longest side (Young 1954), until they are solved.
        const int n = std::max({l.nx, l.ny, l.nz});
        return smooth(l, 2 / (1 + std::sin(std::numbers::pi / (n + 1))), 4 * n);
    }
    smooth(l, smoothing, 2);
    Level& coarse = levels_[level + 1];
    restrict_residual(l, coarse);
    std::fill(coarse.p.begin(), coarse.p.end(), 0.0);
    v_cycle(level + 1);
    add_correction(coarse, l);
    smooth(l, smoothing, 2);
}

double Multigrid::residual() const {
    const Level& l = levels_[0];
    double most = 0;
#pragma omp parallel for collapse(2) schedule(static) reduction(max : most)
    for (int k = 0; k < l.nz; ++k)
        for (int j = 0; j < l.ny; ++j)
            for (int i = 0; i < l.nx; ++i) most = std::max(most, std::abs(l.residual(i, j, k)));
    return most;
}

double Multigrid::right_side() const {
    double most = 0;
    for (double b : levels_[0].b) most = std::max(most, std::abs(b));
    return most;
}

int Multigrid::solve(double tolerance, int most_cycles) {
    const double enough = tolerance * right_side();
    int cycles = 0;
    while (cycles < most_cycles && residual() > enough) v_cycle(), ++cycles;
    return cycles;
}

size_t Multigrid::bytes() const {
    size_t sum = 0;
    for (const auto& l : levels_) sum += (l.p.size() + l.b.size()) * sizeof(double);
    return sum;
}

}  // namespace wetcurl
