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
    for (int i = 0; i < particles; ++i) {
        const float weight = (i == 0 || i == edges ? 0.5f : 1.0f) / float(edges);
        for (int k = 0; k < dct_kept; ++k) {
            const float* b = &basis_[size_t(k) * particles];
            weighted_.push_back(weight * b[i]), rise_.push_back(b[i] - b[0]);
        }
    }
}

namespace {
// Sums by three axes that the registers hold at once.
constexpr int tile = register_bytes == 64 ? 8 : 4;
static_assert(dct_kept % tile == 0);
}  // namespace

template <class S>
void StrandDct::encode(const Vec3<S>* offsets, S* coefficients) const {
    S at_root[3] = {S(0), S(0), S(0)};
    for (int first = 0; first < dct_kept; first += tile) {
        S c[3][tile];
        for (auto& axis : c)
            for (S& sum : axis) sum = S(0);
        const float* b = weighted_.data() + first;
        for (int i = 0; i < particles_; ++i, b += dct_kept) {
            const S x[3] = {offsets[i].x, offsets[i].y, offsets[i].z};
#pragma GCC unroll 8
            for (int k = 0; k < tile; ++k)
#pragma GCC unroll 3
                for (int a = 0; a < 3; ++a) c[a][k] += S(b[k]) * x[a];
        }
        for (int a = 0; a < 3; ++a)
            for (int k = 0; k < tile; ++k) {
                coefficients[dct_kept * a + first + k] = c[a][k];
                at_root[a] += S(projection_[size_t(first + k)]) * c[a][k];
            }
    }
    for (int a = 0; a < 3; ++a)
        for (int k = 0; k < dct_kept; ++k)
            coefficients[dct_kept * a + k] -= S(projection_[size_t(k)]) * at_root[a];
}

// Of `count` particles at once.
template <int count, class S>
static void decode_some(const float* rise, const S* coefficients, Vec3<S>* offsets) {
    S x[3][count];
    for (auto& axis : x)
        for (S& sum : axis) sum = S(0);
    for (int k = 0; k < dct_kept; ++k) {
        const S c[3] = {coefficients[k], coefficients[dct_kept + k], coefficients[2 * dct_kept + k]};
#pragma GCC unroll 8
        for (int i = 0; i < count; ++i)
#pragma GCC unroll 3
            for (int a = 0; a < 3; ++a) x[a][i] += S(rise[i * dct_kept + k]) * c[a];
    }
    for (int i = 0; i < count; ++i) offsets[i] = {x[0][i], x[1][i], x[2][i]};
}

template <class S>
void StrandDct::decode(const S* coefficients, Vec3<S>* offsets) const {
    int i = 0;
    for (; i + tile <= particles_; i += tile)
        decode_some<tile>(&rise_[size_t(i) * dct_kept], coefficients, offsets + i);
    for (; i < particles_; ++i) decode_some<1>(&rise_[size_t(i) * dct_kept], coefficients, offsets + i);
}

template void StrandDct::encode(const Vec3f*, float*) const;
template void StrandDct::encode(const Vec3<Pack<float>>*, Pack<float>*) const;
template void StrandDct::decode(const float*, Vec3f*) const;
template void StrandDct::decode(const Pack<float>*, Vec3<Pack<float>>*) const;

}  // namespace wetcurl
