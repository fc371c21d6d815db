// A number that counts what is computed with it: formulas over any scalar, run once with it, tell how many
// floating-point operations they take.
#pragma once

#include "base/pack.h"

namespace wetcurl {

// Sums, products, quotients and roots count one each; signs, comparisons and choices nothing.
struct Counted {
    static constexpr int lanes = 1;
    struct Mask {
        bool v;
        operator bool() const { return v; }
        bool operator[](int) const { return v; }
    };
    static inline long operations = 0;
    float v;

    Counted() = default;
    template <class U>
    requires std::is_arithmetic_v<U> Counted(U u) : v(float(u)) {}
    float operator[](int) const { return v; }
    void set(int, float to) { v = to; }
    explicit operator int() const { return int(v); }

    friend Counted operator+(Counted a, Counted b) { return ++operations, a.v + b.v; }
    friend Counted operator-(Counted a, Counted b) { return ++operations, a.v - b.v; }
    friend Counted operator*(Counted a, Counted b) { return ++operations, a.v * b.v; }
    friend Counted operator/(Counted a, Counted b) { return ++operations, a.v / b.v; }
    friend Counted sqrt(Counted a) { return ++operations, std::sqrt(a.v); }
    friend Counted exp(Counted a) { return ++operations, std::exp(a.v); }
    friend Counted operator-(Counted a) { return -a.v; }
    Counted& operator+=(Counted b) { return *this = *this + b; }
    Counted& operator-=(Counted b) { return *this = *this - b; }
    Counted& operator*=(Counted b) { return *this = *this * b; }
    friend Mask operator<(Counted a, Counted b) { return {a.v < b.v}; }
    friend Mask operator>(Counted a, Counted b) { return {a.v > b.v}; }
    friend Mask operator<=(Counted a, Counted b) { return {a.v <= b.v}; }
    friend Counted select(bool m, Counted a, Counted b) { return m ? a : b; }
    friend Counted maximum(Counted a, Counted b) { return a.v > b.v ? a : b; }
    friend Counted minimum(Counted a, Counted b) { return a.v < b.v ? a : b; }
    friend bool any_positive(Counted a) { return a.v > 0; }
};
template <>
struct PlainOf<Counted> {
    using type = float;
};

}  // namespace wetcurl
