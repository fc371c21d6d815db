// Amplitudes of a strand.
#include "learn/codec/dct.h"

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
    for (int i = 0; i < particles; ++i)
        for (int k = 0; k < dct_kept; ++k) across_.push_back(basis_[size_t(k) * particles + i]);
}

void StrandDct::encode(const Vec3f* offsets, float* coefficients) const {
    float c[3][dct_kept] = {};
    const int tip = particles_ - 1;
    for (int i = 0; i < particles_; ++i) {
        const float weight = (i == 0 || i == tip ? 0.5f : 1.0f) / float(tip);
        const float* b = across_.data() + size_t(i) * dct_kept;
        const float x[3] = {weight * offsets[i].x, weight * offsets[i].y, weight * offsets[i].z};
        for (int a = 0; a < 3; ++a)
            for (int k = 0; k < dct_kept; ++k) c[a][k] += b[k] * x[a];
    }
    for (int a = 0; a < 3; ++a) {
        float at_root = 0;
        for (int k = 0; k < dct_kept; ++k) at_root += projection_[size_t(k)] * c[a][k];
        for (int k = 0; k < dct_kept; ++k)
            coefficients[dct_kept * a + k] = c[a][k] - projection_[size_t(k)] * at_root;
    }
}

void StrandDct::decode(const float* coefficients, Vec3f* offsets) const {
    // An amplitude goes with the offset that it gives particle 0.
    const float* first = across_.data();
    for (int i = 0; i < particles_; ++i) {
        const float* b = across_.data() + size_t(i) * dct_kept;
        float rise[dct_kept], x[3] = {};
        for (int k = 0; k < dct_kept; ++k) rise[k] = b[k] - first[k];
        for (int a = 0; a < 3; ++a)
            for (int k = 0; k < dct_kept; ++k) x[a] += rise[k] * coefficients[dct_kept * a + k];
        offsets[i] = {x[0], x[1], x[2]};
    }
}

}  // namespace wetcurl
