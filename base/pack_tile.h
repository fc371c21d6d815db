// Rows of floats and their columns as vector registers, a lane a row, where rows are long: a square of
// registers at a time is transposed. base/pack_rows.h is the same for rows of four.
#pragma once

#include <utility>

#include "base/pack.h"

namespace wetcurl {

namespace detail {

template <int distance, int... lane>
inline void swap_parts(Pack<float>& a, Pack<float>& b, std::integer_sequence<int, lane...>) {
    constexpr int lanes = Pack<float>::lanes;
    const auto x = a.v, y = b.v;
    a.v = __builtin_shufflevector(x, y, (lane & distance ? lanes + lane - distance : lane)...);
    b.v = __builtin_shufflevector(x, y, (lane & distance ? lanes + lane : lane + distance)...);
}

}  // namespace detail

// Lane l of register r becomes lane r of register l.
template <int distance = Pack<float>::lanes / 2>
inline void transpose(Pack<float> (&r)[Pack<float>::lanes]) {
    constexpr int lanes = Pack<float>::lanes;
    for (int k = 0; k < lanes; ++k)
        if (!(k & distance))
            detail::swap_parts<distance>(r[k], r[k + distance], std::make_integer_sequence<int, lanes>{});
    if constexpr (distance > 1) transpose<distance / 2>(r);
}

// columns[j], j < count: in lane l the sum over k < width of weight[l * width + k] row[l * width + k][j].
inline void weighted_columns(int count, int width, const float* const* row, const float* weight,
                             Pack<float>* columns) {
    using S = Pack<float>;
    if (count < S::lanes) {
        for (int j = 0; j < count; ++j)
            for (int lane = 0; lane < S::lanes; ++lane) {
                float sum = 0;
                for (int k = lane * width; k < (lane + 1) * width; ++k) sum += weight[k] * row[k][j];
                columns[j].set(lane, sum);
            }
        return;
    }
    // The last square may overlap the one before.
    for (int next = 0; next < count; next += S::lanes) {
        const int first = minimum(next, count - S::lanes);
        S r[S::lanes];
        for (int lane = 0; lane < S::lanes; ++lane) {
            S sum(0);
            for (int k = lane * width; k < (lane + 1) * width; ++k)
                sum += S(weight[k]) * S::load(row[k] + first);
            r[lane] = sum;
        }
        transpose(r);
        for (int j = 0; j < S::lanes; ++j) columns[first + j] = r[j];
    }
}

// row[l][j] = lane l of columns[j], j < count; rows that are null are left out.
inline void rows_of(int count, const Pack<float>* columns, float* const* row) {
    using S = Pack<float>;
    if (count < S::lanes) {
        for (int lane = 0; lane < S::lanes; ++lane)
            for (int j = 0; row[lane] && j < count; ++j) row[lane][j] = columns[j][lane];
        return;
    }
    for (int next = 0; next < count; next += S::lanes) {
        const int first = minimum(next, count - S::lanes);
        S r[S::lanes];
        for (int j = 0; j < S::lanes; ++j) r[j] = columns[first + j];
        transpose(r);
        for (int lane = 0; lane < S::lanes; ++lane)
            if (row[lane]) r[lane].store(row[lane] + first);
    }
}

}  // namespace wetcurl
