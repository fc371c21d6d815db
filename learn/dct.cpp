// Amplitudes of a strand.
// Ours.
#include "learn/dct.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/error.h"

namespace wetcurl {

StrandDct::StrandDct(int particles) : particles_(particles), projection_(dct_kept, 0) {
    if (particles < 2)
        throw Error("strand codec: found " + std::to_string(particles) +
                    " particles a strand, allowed 2 or more");
    const int edges = particles - 1;
    basis_.assign(size_t(dct_kept) * particles, 0);
    double length2 = 0;
    for (int k = 0; k < std::min(dct_kept, particles); ++k) {
        // The last of all changes sign from particle to particle: its mean square is twice that of the
        // others.
        const double s = k == 0 || k == edges ? 1 : std::numbers::sqrt2;
        for (int i = 0; i < particles; ++i)
            basis_[size_t(k) * particles + i] = float(s * std::cos(std::numbers::pi * k * i / edges));
        length2 += s * s;
    }
    for (int k = 0; k < dct_kept; ++k)
        projection_[size_t(k)] = float(basis_[size_t(k) * particles] / std::sqrt(length2));
}

void StrandDct::encode(const Vec3f* offsets, float* coefficients) const {
    Vec3f c[dct_kept], at_root{0, 0, 0};
    const int tip = particles_ - 1;
    for (int k = 0; k < dct_kept; ++k) {
        const float* b = basis_.data() + size_t(k) * particles_;
        Vec3f sum = 0.5f * (b[0] * offsets[0] + b[tip] * offsets[tip]);
        for (int i = 1; i < tip; ++i) sum += b[i] * offsets[i];
        c[k] = (1.0f / float(tip)) * sum;
        at_root += projection_[size_t(k)] * c[k];
    }
    for (int k = 0; k < dct_kept; ++k) {
        const Vec3f a = c[k] - projection_[size_t(k)] * at_root;
        coefficients[k] = a.x;
        coefficients[dct_kept + k] = a.y;
        coefficients[2 * dct_kept + k] = a.z;
    }
}

void StrandDct::decode(const float* coefficients, Vec3f* offsets) const {
    for (int i = 0; i < particles_; ++i) offsets[i] = {0, 0, 0};
    for (int k = 1; k < dct_kept; ++k) {  // k = 0 is a constant: it goes with the offset at particle 0
        const float* b = basis_.data() + size_t(k) * particles_;
        const Vec3f c{coefficients[k], coefficients[dct_kept + k], coefficients[2 * dct_kept + k]};
        for (int i = 0; i < particles_; ++i) offsets[i] += (b[i] - b[0]) * c;
    }
}

}  // namespace wetcurl
