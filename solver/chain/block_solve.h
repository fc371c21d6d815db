// The direct solve of one strand's block-pentadiagonal system, 3x3 blocks, LDL^T; block-tridiagonal where no
// term couples two edges. Golub and Van Loan, 4.3 (banded), on blocks; a lane is a strand.
#pragma once

#include "base/vec3.h"

namespace wetcurl {

// 1 / pivot. A pivot is a normal number; a device's division takes time to see whether it is.
template <class S>
WETCURL_HD S inverse_of_pivot(const S& pivot) {
#if defined(__CUDA_ARCH__) && !defined(WETCURL_PARITY)
    if constexpr (std::is_same_v<S, float>) {
        float inverse;
        asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(inverse) : "f"(pivot));
        return inverse;
    }
#endif
    return S(1) / pivot;
}

// LDL^T of a symmetric positive definite 3x3 matrix.
template <class S>
struct Factor3 {
    S l10, l20, l21, i0, i1, i2;  // inverses of the pivots
    WETCURL_HD explicit Factor3(const Sym3<S>& m) {
        i0 = inverse_of_pivot(m.xx);
        l10 = m.xy * i0;
        l20 = m.xz * i0;
        i1 = inverse_of_pivot(m.yy - l10 * m.xy);
        const S s21 = m.yz - l20 * m.xy;
        l21 = s21 * i1;
        i2 = inverse_of_pivot(m.zz - l20 * m.xz - l21 * s21);
    }
    WETCURL_HD Vec3<S> solve(const Vec3<S>& b) const {
        const S y = b.y - l10 * b.x, z = (b.z - l20 * b.x - l21 * y) * i2;
        const S v = y * i1 - l21 * z;
        return {b.x * i0 - l10 * v - l20 * z, v, z};
    }
    // The three columns of B at once, by rows.
    WETCURL_HD Mat3<S> solve(const Mat3<S>& b) const {
        const Vec3<S> y = b.r1 - l10 * b.r0;
        const Vec3<S> z = i2 * (b.r2 - l20 * b.r0 - l21 * y);
        const Vec3<S> v = i1 * y - l21 * z;
        return {i0 * b.r0 - l10 * v - l20 * z, v, z};
    }
};

// a - U^T P, where U^T P is symmetric.
template <class S>
WETCURL_HD void subtract_symmetric(Sym3<S>& a, const Mat3<S>& u, const Mat3<S>& p) {
    a.xx -= u.r0.x * p.r0.x + u.r1.x * p.r1.x + u.r2.x * p.r2.x;
    a.xy -= u.r0.x * p.r0.y + u.r1.x * p.r1.y + u.r2.x * p.r2.y;
    a.xz -= u.r0.x * p.r0.z + u.r1.x * p.r1.z + u.r2.x * p.r2.z;
    a.yy -= u.r0.y * p.r0.y + u.r1.y * p.r1.y + u.r2.y * p.r2.y;
    a.yz -= u.r0.y * p.r0.z + u.r1.y * p.r1.z + u.r2.y * p.r2.z;
    a.zz -= u.r0.z * p.r0.z + u.r1.z * p.r1.z + u.r2.z * p.r2.z;
}
template <class S>
WETCURL_HD Mat3<S> transposed_product(const Mat3<S>& u, const Mat3<S>& q) {
    return {u.r0.x * q.r0 + u.r1.x * q.r1 + u.r2.x * q.r2, u.r0.y * q.r0 + u.r1.y * q.r1 + u.r2.y * q.r2,
            u.r0.z * q.r0 + u.r1.z * q.r1 + u.r2.z * q.r2};
}

// A row of the system and its couplings to the one and the two rows that are eliminated after it. Taken off
// them it becomes the row of the substitution: x = r - u1 x_1 - u2 x_2.
template <class S>
struct BlockRow {
    const Sym3<S>& diagonal;
    Mat3<S>*u1, *u2;  // null: that row is not there, or (u2) no term couples so far
    Vec3<S>& r;
};
// `diagonal1`, `r1`, `u11` (its coupling to row 2), `diagonal2`, `r2` of the rows after it.
template <class S>
WETCURL_HD void eliminate(const BlockRow<S>& row, Sym3<S>* diagonal1, Vec3<S>* r1, Mat3<S>* u11,
                          Sym3<S>* diagonal2, Vec3<S>* r2) {
    const Factor3<S> f(row.diagonal);
    const Vec3<S> y = f.solve(row.r);
    if (row.u1) {
        const Mat3<S>& u1 = *row.u1;
        const Mat3<S> p = f.solve(u1);
        subtract_symmetric(*diagonal1, u1, p);
        *r1 -= transposed_times(u1, y);
        if (row.u2) {
            const Mat3<S>& u2 = *row.u2;
            const Mat3<S> q = f.solve(u2);
            *u11 -= transposed_product(u1, q);
            subtract_symmetric(*diagonal2, u2, q);
            *r2 -= transposed_times(u2, y);
            assign(*row.u2, q);
        }
        assign(*row.u1, p);
    }
    row.r = y;
}

// Of a whole system: takes row i off those after it, and the substitution once all are. `diagonal`: of rows
// i, i+1 and i+2.
template <bool Penta, class S>
WETCURL_HD void eliminate_row(int i, int n, Sym3<S>* diagonal, Mat3<S>* upper1, Mat3<S>* upper2, Vec3<S>* r) {
    const BlockRow<S> row{diagonal[0], i + 1 < n ? &upper1[i] : nullptr,
                          Penta && i + 2 < n ? &upper2[i] : nullptr, r[i]};
    eliminate(row, diagonal + 1, &r[i + 1], &upper1[i + 1], diagonal + 2, &r[i + 2]);
}
template <bool Penta, class S>
WETCURL_HD void substitute_rows(int first, int n, const Mat3<S>* upper1, const Mat3<S>* upper2, Vec3<S>* r) {
    for (int i = n - 2; i >= first; --i) {
        if constexpr (Penta)
            if (i + 2 < n) r[i] -= upper2[i] * r[i + 2];
        r[i] -= upper1[i] * r[i + 1];
    }
}

// Solves A x = r for rows first..n-1 in place: r becomes x; diagonal, upper1, upper2 are destroyed.
template <bool Penta, class S>
WETCURL_HD void solve_blocks(int first, int n, Sym3<S>* diagonal, Mat3<S>* upper1, Mat3<S>* upper2,
                             Vec3<S>* r) {
    for (int i = first; i < n; ++i) eliminate_row<Penta>(i, n, diagonal + i, upper1, upper2, r);
    substitute_rows<Penta>(first, n, upper1, upper2, r);
}

}  // namespace wetcurl
