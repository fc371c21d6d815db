// The kernels that the compared methods share: adhesion A and cohesion C, of support h [m].
// Akinci 2013, Eq 2 (C) and Eq 7 (A); a boundary particle's volume: Akinci 2012, Eq 4.
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "base/geometry/kernels.h"
#include "solver/terms/adhesion.h"

namespace wetcurl::akinci2013 {

// A(r) = 0.007 / h^3.25 (-4 r²/h + 6 r - 2 h)^(1/4) [1/m^3] on (h/2, h], else 0: attraction alone.
WETCURL_HD inline double adhesion_kernel(double r, double h) {
    return 0.007 / std::numbers::sqrt2 / (h * h * h) * Adhesion::akinci_shape(r / h);
}

// C(r) [1/m^3]: attraction beyond 0.273 h, repulsion nearer, 0 from h on. As Akinci 2013 prints it, the
// h^6 / 64 stands inside the factor here: else C jumps at h/2.
WETCURL_HD inline double cohesion_kernel(double r, double h) {
    if (!(r < h)) return 0;
    const double q = r / h, u = (1 - q) * q, cube = u * u * u;
    return 32 / (std::numbers::pi * h * h * h) * (q > 0.5 ? cube : 2 * cube - 1.0 / 64);
}

// The sum of a kernel K(r, h) [1/m^3] from r to its end h [1/m^2], from a table: minus the energy of a pair
// of particles, for each unit of its strength. A has no closed form.
struct KernelTable {
    static constexpr size_t cells = 4096;
    double cell;        // [m]
    const double* sum;  // (cells + 1)
    WETCURL_HD double operator()(double r) const {
        const double at = r / cell;
        if (!(at < double(cells))) return 0;
        const size_t k = size_t(at);
        return sum[k] + (at - double(k)) * (sum[k + 1] - sum[k]);
    }
};
class KernelSum {
  public:
    template <class K>
    KernelSum(K kernel, double h) : cell_(h / cells), sum_(cells + 1, 0.0) {
        for (size_t k = cells; k-- > 0;) sum_[k] = sum_[k + 1] + cell_ * kernel((double(k) + 0.5) * cell_, h);
    }
    double operator()(double r) const { return KernelTable{cell_, sum_.data()}(r); }
    double cell() const { return cell_; }
    const std::vector<double>& sum() const { return sum_; }
    size_t bytes() const { return sum_.capacity() * sizeof(double); }

  private:
    static constexpr size_t cells = KernelTable::cells;
    double cell_;
    std::vector<double> sum_;
};

// Of two particles [J], `strength` [N m^3/kg^2], K the sum of its kernel [1/m^2].
WETCURL_HD inline double pair_energy(double strength, double wet_i, double wet_j, double m_i, double m_j,
                                     double K) {
    return -strength * wet_i * wet_j * m_i * m_j * K;
}

// d / |d|; none for particles in the same place.
WETCURL_HD inline Vec3d direction(const Vec3d& d) { return normalized(d, Vec3d{0, 0, 0}); }

}  // namespace wetcurl::akinci2013
