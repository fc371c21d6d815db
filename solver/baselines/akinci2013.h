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
inline double adhesion_kernel(double r, double h) {
    return 0.007 / std::numbers::sqrt2 / (h * h * h) * Adhesion::akinci_shape(r / h);
}

// C(r) [1/m^3]: attraction beyond 0.273 h, repulsion nearer, 0 from h on. As Akinci 2013 prints it, the
// h^6 / 64 stands inside the factor (EQUATIONS Sec. 4): else C jumps at h/2.
inline double cohesion_kernel(double r, double h) {
    if (!(r < h)) return 0;
    const double q = r / h, u = (1 - q) * q, cube = u * u * u;
    return 32 / (std::numbers::pi * h * h * h) * (q > 0.5 ? cube : 2 * cube - 1.0 / 64);
}

// d / |d|; none for particles in the same place.
inline Vec3d direction(const Vec3d& d) { return normalized(d, Vec3d{0, 0, 0}); }

}  // namespace wetcurl::akinci2013
