// Products of sines, by products of matrices.
#include "solver/air/poisson.h"

#include <cmath>
#include <Eigen/Core>
#include <numbers>

namespace wetcurl {

SineBasis::SineBasis(int n, double cell) : n(n), vector(size_t(n) * size_t(n)), value(size_t(n)) {
    for (int k = 0; k < n; ++k) {
        const double angle = std::numbers::pi * (k + 1) / n;
        value[size_t(k)] = (2 - 2 * std::cos(angle)) / (cell * cell);
        const double scale = std::sqrt((k + 1 == n ? 1.0 : 2.0) / n);
        for (int i = 0; i < n; ++i)
            vector[size_t(k) * size_t(n) + size_t(i)] = scale * std::sin(angle * (i + 0.5));
    }
}

PoissonBox::PoissonBox(const std::array<int, 3>& cells, double cell)
    : basis_{SineBasis(cells[0], cell), SineBasis(cells[1], cell), SineBasis(cells[2], cell)},
      spare_(size_t(cells[0]) * size_t(cells[1]) * size_t(cells[2])) {}

// A plane of x and y to its sines and, once those of z are taken too, back. Each product is one thread's.
void PoissonBox::solve(std::vector<double>& b) {
    using Matrix = Eigen::MatrixXd;
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    const SineBasis &x = basis_[0], &y = basis_[1], &z = basis_[2];
    const long plane = long(x.n) * y.n;
    const Eigen::Map<const Rows> qx(x.vector.data(), x.n, x.n), qy(y.vector.data(), y.n, y.n),
        qz(z.vector.data(), z.n, z.n);
    auto at = [&](std::vector<double>& v, long first) { return v.data() + first; };
#pragma omp parallel
    {
#pragma omp for schedule(static)
        for (int k = 0; k < z.n; ++k) {
            Eigen::Map<Matrix> here(at(b, k * plane), x.n, y.n), there(at(spare_, k * plane), x.n, y.n);
            there.noalias() = qx * here;
            here.noalias() = there * qy.transpose();
        }
        // A row of x at one y, in all planes.
#pragma omp for schedule(static)
        for (int j = 0; j < y.n; ++j) {
            using Planes = Eigen::Map<Matrix, 0, Eigen::OuterStride<>>;
            const Eigen::OuterStride<> step(plane);
            Planes here(at(b, long(j) * x.n), x.n, z.n, step),
                there(at(spare_, long(j) * x.n), x.n, z.n, step);
            there.noalias() = here * qz.transpose();
            for (int k = 0; k < z.n; ++k)
                for (int i = 0; i < x.n; ++i)
                    there(i, k) /= x.value[size_t(i)] + y.value[size_t(j)] + z.value[size_t(k)];
            here.noalias() = there * qz;
        }
#pragma omp for schedule(static)
        for (int k = 0; k < z.n; ++k) {
            Eigen::Map<Matrix> here(at(b, k * plane), x.n, y.n), there(at(spare_, k * plane), x.n, y.n);
            there.noalias() = here * qy;
            here.noalias() = qx.transpose() * there;
        }
    }
}

size_t PoissonBox::bytes() const {
    size_t sum = spare_.capacity();
    for (const auto& basis : basis_) sum += basis.vector.capacity() + basis.value.capacity();
    return sum * sizeof(double);
}

}  // namespace wetcurl
