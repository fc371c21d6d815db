// A vector register seen as quads of numbers: a few points meet four others at once. Ours, after the cluster
// pairs of Pall and Hess 2013 (GROMACS).
#pragma once

#include "base/pack.h"
#include "base/vec3.h"

namespace wetcurl {

inline constexpr int quads = lanes_of<float> / 4;

// from[0 .. 3] in each quad.
inline Pack<float> in_each_quad(const float* from) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
    return Pack<float>::Register(_mm512_maskz_broadcast_f32x4(0xffff, _mm_loadu_ps(from)));
#elif defined(__AVX2__)
    return Pack<float>::Register(_mm256_broadcast_ps(reinterpret_cast<const __m128*>(from)));
#else
    return Pack<float>::load(from);
#endif
}
// The same where a lane's bit is set, else 0.
inline Pack<float> in_each_quad(const float* from, uint32_t bits) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
    return Pack<float>::Register(_mm512_maskz_broadcast_f32x4(__mmask16(bits), _mm_loadu_ps(from)));
#else
    return select(mask_of(bits), in_each_quad(from), Pack<float>(0));
#endif
}
// from[q] four times in quad q; reads from[0 .. 3].
inline Pack<float> a_quad_each(const float* from) {
    Pack<float>::Mask place{};
    for (int l = 0; l < Pack<float>::lanes; ++l) place[l] = l / 4;
    return __builtin_shuffle(in_each_quad(from).v, place);
}
// The sums over each quad of a, b, c and d: quad q of the result holds those of quad q.
inline Pack<float> sums_of_quads(Pack<float> a, Pack<float> b, Pack<float> c, Pack<float> d) {
    constexpr int lanes = Pack<float>::lanes;
    Pack<float>::Mask low{}, high{}, first{}, second{};
    for (int q = 0; q < lanes; q += 4)
        for (int l = 0; l < 2; ++l) {
            low[q + 2 * l] = q + l, low[q + 2 * l + 1] = lanes + q + l;
            high[q + 2 * l] = q + 2 + l, high[q + 2 * l + 1] = lanes + q + 2 + l;
            first[q + l] = q + l, first[q + 2 + l] = lanes + q + l;
            second[q + l] = q + 2 + l, second[q + 2 + l] = lanes + q + 2 + l;
        }
    const auto ab = __builtin_shuffle(a.v, b.v, low) + __builtin_shuffle(a.v, b.v, high),
               cd = __builtin_shuffle(c.v, d.v, low) + __builtin_shuffle(c.v, d.v, high);
    return __builtin_shuffle(ab, cd, first) + __builtin_shuffle(ab, cd, second);
}

}  // namespace wetcurl
