// A vector register seen as a number: one lane, one strand. Formulas templated on their scalar take a
// Pack on the CPU and a float on the GPU or in a test. Ours, on the compiler's vector extension.
#pragma once

#include <cmath>
#include <limits>

#include "base/host_device.h"

namespace wetcurl {

// Lanes of a 64-byte register.
template <class T>
inline constexpr int lanes_of = 64 / int(sizeof(T));

template <class T>
struct RegisterOf;
template <>
struct RegisterOf<float> {
    typedef float type __attribute__((vector_size(64)));
};
template <>
struct RegisterOf<double> {
    typedef double type __attribute__((vector_size(64)));
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
    requires std::is_arithmetic_v<U> Pack(U u) : v(Register{} + T(u)) {}

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
template <class T>
bool any_positive(Pack<T> a) {
    bool any = false;
    for (int l = 0; l < Pack<T>::lanes; ++l) any |= a.v[l] > 0;
    return any;
}
template <class T>
Pack<T> maximum(Pack<T> a, Pack<T> b) {
    return a.v > b.v ? a.v : b.v;
}
template <class T>
Pack<T> minimum(Pack<T> a, Pack<T> b) {
    return a.v < b.v ? a.v : b.v;
}

WETCURL_HD inline float select(bool m, float a, float b) { return m ? a : b; }
WETCURL_HD inline double select(bool m, double a, double b) { return m ? a : b; }
WETCURL_HD inline bool any_positive(float a) { return a > 0; }
WETCURL_HD inline bool any_positive(double a) { return a > 0; }
WETCURL_HD inline float maximum(float a, float b) { return a > b ? a : b; }
WETCURL_HD inline double maximum(double a, double b) { return a > b ? a : b; }
WETCURL_HD inline float minimum(float a, float b) { return a < b ? a : b; }
WETCURL_HD inline double minimum(double a, double b) { return a < b ? a : b; }
using std::sqrt;

// Below this a length counts as zero [m]; far under a segment of hair, far above rounding's floor.
template <class S>
inline constexpr Plain<S> tiny_length = Plain<S>(1e-12);

}  // namespace wetcurl
