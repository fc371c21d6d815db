// A vector register seen as a number: one lane, one strand. Formulas templated on their scalar take a
// Pack on the CPU and a float on the GPU or in a test. Ours, on the compiler's vector extension.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#ifdef __SSE2__
#include <immintrin.h>
#endif

#include "base/host_device.h"

namespace wetcurl {

// Bytes of the processor's registers: compilers take wider vectors apart number by number.
#if defined(__AVX512F__) && defined(__AVX512DQ__)
inline constexpr int register_bytes = 64;
#elif defined(__AVX2__)
inline constexpr int register_bytes = 32;
#else
inline constexpr int register_bytes = 16;
#endif
template <class T>
inline constexpr int lanes_of = register_bytes / int(sizeof(T));

template <class T>
struct RegisterOf;
template <>
struct RegisterOf<float> {
    typedef float type __attribute__((vector_size(register_bytes)));
};
template <>
struct RegisterOf<double> {
    typedef double type __attribute__((vector_size(register_bytes)));
};

template <class T>
struct Pack {
    static constexpr int lanes = lanes_of<T>;
    using Register = typename RegisterOf<T>::type;
    using Mask = decltype(Register{} < Register{});
    Register v;

    Pack() = default;
    Pack(Register r) : v(r) {}
    template <class U>
    requires std::is_arithmetic_v<U> Pack(U u) : v(filled(T(u), std::make_integer_sequence<int, lanes>())) {}

    // From memory of any alignment.
    static Pack load(const T* from) {
        Pack p;
        std::memcpy(&p.v, from, sizeof p.v);
        return p;
    }
    // The same way back.
    void store(T* to) const { std::memcpy(to, &v, sizeof v); }
    T operator[](int lane) const { return v[lane]; }
    void set(int lane, T t) { v[lane] = t; }

    friend Pack operator+(Pack a, Pack b) { return a.v + b.v; }
    friend Pack operator-(Pack a, Pack b) { return a.v - b.v; }
    friend Pack operator*(Pack a, Pack b) { return a.v * b.v; }
    friend Pack operator/(Pack a, Pack b) { return a.v / b.v; }
    friend Pack operator-(Pack a) { return -a.v; }
    Pack& operator+=(Pack b) {
        v += b.v;
        return *this;
    }
    Pack& operator-=(Pack b) {
        v -= b.v;
        return *this;
    }
    Pack& operator*=(Pack b) {
        v *= b.v;
        return *this;
    }
    friend Mask operator<(Pack a, Pack b) { return a.v < b.v; }
    friend Mask operator>(Pack a, Pack b) { return a.v > b.v; }
    friend Mask operator<=(Pack a, Pack b) { return a.v <= b.v; }

  private:
    // By an instruction, from memory too; a sum with zeros is another before it.
    template <int... lane>
    static Register filled(T t, std::integer_sequence<int, lane...>) {
        return Register{(static_cast<void>(lane), t)...};
    }
};

// The plain number under a scalar: float for float and for Pack<float>.
template <class S>
struct PlainOf {
    using type = S;
};
template <class T>
struct PlainOf<Pack<T>> {
    using type = T;
};
template <class S>
using Plain = typename PlainOf<S>::type;

template <class T>
Pack<T> sqrt(Pack<T> a) {
    Pack<T> r;
    for (int l = 0; l < Pack<T>::lanes; ++l) r.v[l] = std::sqrt(a.v[l]);
    return r;
}
template <class T>
Pack<T> select(typename Pack<T>::Mask m, Pack<T> a, Pack<T> b) {
    return m ? a.v : b.v;
}
// A bit for each lane of a mask, and back.
template <class M>
inline uint32_t bits_of(M m) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
    if constexpr (sizeof(m[0]) == 4)
        return _mm512_movepi32_mask(__m512i(m));
    else
        return _mm512_movepi64_mask(__m512i(m));
#elif defined(__AVX2__)
    if constexpr (sizeof(m[0]) == 4)
        return uint32_t(_mm256_movemask_ps(__m256(m)));
    else
        return uint32_t(_mm256_movemask_pd(__m256d(m)));
#elif defined(__SSE2__)
    if constexpr (sizeof(m[0]) == 4)
        return uint32_t(_mm_movemask_ps(__m128(m)));
    else
        return uint32_t(_mm_movemask_pd(__m128d(m)));
#else
    uint32_t bits = 0;
    for (int l = 0; l < int(sizeof m / sizeof m[0]); ++l) bits |= uint32_t(m[l] & 1) << l;
    return bits;
#endif
}
inline Pack<float>::Mask mask_of(uint32_t bits) {
    Pack<float>::Mask lane{};
    for (int l = 0; l < Pack<float>::lanes; ++l) lane[l] = 1 << l;
    return ((Pack<float>::Mask{} + int(bits)) & lane) != 0;
}
template <class T>
bool any_positive(Pack<T> a) {
    return bits_of(a > Pack<T>(0)) != 0;
}
template <class T>
Pack<T> maximum(Pack<T> a, Pack<T> b) {
    return a.v > b.v ? a.v : b.v;
}
template <class T>
Pack<T> minimum(Pack<T> a, Pack<T> b) {
    return a.v < b.v ? a.v : b.v;
}
#if defined(__AVX512F__) && defined(__AVX512DQ__)
// The same to the bit, zeros and NaN too, in one instruction where GCC makes two. All lanes are asked for by
// a mask: GCC 12 warns of its own header without.
inline Pack<float> maximum(Pack<float> a, Pack<float> b) {
    return Pack<float>::Register(_mm512_maskz_max_ps(0xffff, __m512(a.v), __m512(b.v)));
}
inline Pack<double> maximum(Pack<double> a, Pack<double> b) {
    return Pack<double>::Register(_mm512_maskz_max_pd(0xff, __m512d(a.v), __m512d(b.v)));
}
inline Pack<float> minimum(Pack<float> a, Pack<float> b) {
    return Pack<float>::Register(_mm512_maskz_min_ps(0xffff, __m512(a.v), __m512(b.v)));
}
inline Pack<double> minimum(Pack<double> a, Pack<double> b) {
    return Pack<double>::Register(_mm512_maskz_min_pd(0xff, __m512d(a.v), __m512d(b.v)));
}
#endif

WETCURL_HD inline float select(bool m, float a, float b) { return m ? a : b; }
WETCURL_HD inline double select(bool m, double a, double b) { return m ? a : b; }
WETCURL_HD inline bool any_positive(float a) { return a > 0; }
WETCURL_HD inline bool any_positive(double a) { return a > 0; }
WETCURL_HD inline float maximum(float a, float b) { return a > b ? a : b; }
WETCURL_HD inline double maximum(double a, double b) { return a > b ? a : b; }
WETCURL_HD inline int maximum(int a, int b) { return a > b ? a : b; }
WETCURL_HD inline int minimum(int a, int b) { return a < b ? a : b; }
WETCURL_HD inline float minimum(float a, float b) { return a < b ? a : b; }
WETCURL_HD inline double minimum(double a, double b) { return a < b ? a : b; }
using std::sqrt;

// Below this a length counts as zero [m]; far under a segment of hair, far above rounding's floor.
template <class S>
inline constexpr Plain<S> tiny_length = Plain<S>(1e-12);

}  // namespace wetcurl
