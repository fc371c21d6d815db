// A vector register seen as quads of numbers: a few points meet four others at once. Ours, after the cluster
// pairs of Pall and Hess 2013 (GROMACS).
#pragma once

#include <utility>

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

namespace detail {

using Floats = Pack<float>::Register;

template <int (*place)(int), int... lane>
Floats gathered(Floats a, Floats b, std::integer_sequence<int, lane...>) {
    return __builtin_shufflevector(a, b, place(lane)...);
}
// In lane l that of place(l), which counts those of b after those of a.
template <int (*place)(int)>
Floats gathered(Floats a, Floats b) {
    return gathered<place>(a, b, std::make_integer_sequence<int, Pack<float>::lanes>());
}

constexpr int quad_of(int lane) { return lane / 4; }
// Of lanes 0 and 1, then 2 and 3, of a quad: of a and of b in turn.
constexpr int first_two_in_turn(int lane) {
    return lane % 2 * Pack<float>::lanes + lane / 4 * 4 + lane % 4 / 2;
}
constexpr int last_two_in_turn(int lane) { return first_two_in_turn(lane) + 2; }
// Of a, then of b.
constexpr int first_two(int lane) { return lane % 4 / 2 * Pack<float>::lanes + lane / 4 * 4 + lane % 2; }
constexpr int last_two(int lane) { return first_two(lane) + 2; }

}  // namespace detail

// from[q] four times in quad q; reads from[0 .. 3].
inline Pack<float> a_quad_each(const float* from) {
    const auto each = in_each_quad(from).v;
    return detail::gathered<detail::quad_of>(each, each);
}
// The sums over each quad of a, b, c and d: quad q of the result holds those of quad q.
inline Pack<float> sums_of_quads(Pack<float> a, Pack<float> b, Pack<float> c, Pack<float> d) {
    using namespace detail;
    const auto ab = gathered<first_two_in_turn>(a.v, b.v) + gathered<last_two_in_turn>(a.v, b.v),
               cd = gathered<first_two_in_turn>(c.v, d.v) + gathered<last_two_in_turn>(c.v, d.v);
    return gathered<first_two>(ab, cd) + gathered<last_two>(ab, cd);
}

}  // namespace wetcurl
