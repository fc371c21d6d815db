// Strand-interleaved memory as the device has it: rows of 32 numbers, one for each lane of a warp. A host
// buffer of Vec3<Lanes<T>> and the device's three rows of T are the same bytes. Ours.
#pragma once

#include <cstring>
#include <type_traits>

#include "base/vec3.h"

namespace wetcurl {

template <class T>
struct Lanes {
    static constexpr int lanes = 32;
    T v[lanes];

    Lanes() = default;
    template <class U>
    requires std::is_arithmetic_v<U>
    explicit Lanes(U u) {
        for (T& t : v) t = T(u);
    }
    T operator[](int lane) const { return v[lane]; }
    void set(int lane, T t) { v[lane] = t; }
};
template <class T>
struct PlainOf<Lanes<T>> {
    using type = T;
};

// One lane's elements: E is T, Vec3<T>, Quat<T>…, element i of the strand in as many rows as E has numbers.
// T may be const.
template <class E, class T>
struct LaneArray {
    static constexpr int rows = int(sizeof(E) / sizeof(T));
    T* p;  // this lane's number in the first row

    WETCURL_HD E operator[](int i) const {
        std::remove_const_t<T> numbers[rows];
        const T* from = p + size_t(i) * (rows * Lanes<T>::lanes);
        for (int r = 0; r < rows; ++r) numbers[r] = from[r * Lanes<T>::lanes];
        E e;
        memcpy(&e, numbers, sizeof e);
        return e;
    }
    WETCURL_HD void set(int i, const E& e) const {
        T numbers[rows];
        memcpy(numbers, &e, sizeof e);
        T* to = p + size_t(i) * (rows * Lanes<T>::lanes);
        for (int r = 0; r < rows; ++r) to[r * Lanes<T>::lanes] = numbers[r];
    }
};

}  // namespace wetcurl
