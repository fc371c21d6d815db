// What groups of cases share.
#include "solver/stability/cases.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wetcurl::stability {

StrandSetup wet_lock(const Battery& b, double k_over_m) {
    StrandSetup lock{.k_over_m = k_over_m, .more = "[wetness]\n" + b.method.cohesion};
    const Points curl = helix_points(particles, length, 0.002, 0.02);
    for (int k = 0; k < 7; ++k) {
        const double angle = k * std::numbers::pi / 3, apart = k == 0 ? 0 : 0.008;  // [m]
        Points& strand = lock.shapes.emplace_back(curl);
        for (auto& p : strand)
            p = rotate(rotation_about({0, 1, 0}, 0.9 * k), p) +
                Vec3d{apart * std::cos(angle), 0, apart * std::sin(angle)};
    }
    return lock;
}

double slowest_swing(const Battery& b, double k_over_m) {
    // A chain's lowest mode: 1.2 is half the first zero of J_0.
    if (b.method.fibre > 0) return 1.2 * std::sqrt(9.81 / length);
    return 0.5 * std::numbers::pi / particles * std::sqrt(2 * k_over_m);
}

double critical_drag(double swing) { return std::min(2 * swing, 20.0); }

double rms_distance(const Points& a, const Points& b) {
    double sum = 0;
    for (size_t i = 0; i < a.size(); ++i) sum += dot(a[i] - b[i], a[i] - b[i]);
    return std::sqrt(sum / double(a.size()));
}

}  // namespace wetcurl::stability
