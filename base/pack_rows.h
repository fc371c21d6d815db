// Rows of four floats and their columns as vector registers: a lane a row. Ours, on the compiler's vector
// extension.
#pragma once

#include "base/pack.h"

namespace wetcurl {

// Four floats side by side.
typedef float FourFloats __attribute__((vector_size(16)));
// From and to memory of any alignment. By an instruction each: GCC takes a memcpy of it apart.
typedef float FourFloatsAnywhere __attribute__((vector_size(16), may_alias, aligned(4)));
inline FourFloats four_at(const void* from) { return *static_cast<const FourFloatsAnywhere*>(from); }
inline void put_four(FourFloats four, void* to) { *static_cast<FourFloatsAnywhere*>(to) = four; }

namespace detail {
// Four rows become four columns.
inline void transpose(FourFloats (&r)[4]) {
    const FourFloats a = __builtin_shufflevector(r[0], r[1], 0, 4, 1, 5),
                     b = __builtin_shufflevector(r[0], r[1], 2, 6, 3, 7),
                     c = __builtin_shufflevector(r[2], r[3], 0, 4, 1, 5),
                     d = __builtin_shufflevector(r[2], r[3], 2, 6, 3, 7);
    r[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5), r[1] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
    r[2] = __builtin_shufflevector(b, d, 0, 1, 4, 5), r[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}
}  // namespace detail

struct FourColumns {
    static constexpr int lanes = Pack<float>::lanes;
    Pack<float> column[4];
    Pack<float>& operator[](int c) { return column[c]; }
    const Pack<float>& operator[](int c) const { return column[c]; }

    // Of the four floats at row(lane).
    template <class Row>
    static FourColumns of(Row row) {
        FourColumns out;
        for (int lane = 0; lane < lanes; lane += 4) {
            FourFloats r[4] = {four_at(row(lane)), four_at(row(lane + 1)), four_at(row(lane + 2)),
                               four_at(row(lane + 3))};
            detail::transpose(r);
            for (int c = 0; c < 4; ++c) put_four(r[c], reinterpret_cast<float*>(&out.column[c]) + lane);
        }
        return out;
    }
    // row(lane, four) for all lanes.
    template <class Row>
    void rows(Row row) const {
        for (int lane = 0; lane < lanes; lane += 4) {
            const auto four = [&](int c) {
                return four_at(reinterpret_cast<const float*>(&column[c]) + lane);
            };
            FourFloats r[4] = {four(0), four(1), four(2), four(3)};
            detail::transpose(r);
            for (int k = 0; k < 4; ++k) row(lane + k, r[k]);
        }
    }
};

}  // namespace wetcurl
