// Transforms as Alembic and USD write them: rows of four, points as rows, p' = p M.
#pragma once

#include "base/vec3.h"

namespace wetcurl {

struct RowMatrix {
    double m[4][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}, {0, 0, 0, 1}};
    bool operator==(const RowMatrix&) const = default;

    // First a, then b.
    friend RowMatrix operator*(const RowMatrix& a, const RowMatrix& b) {
        RowMatrix out;
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j) {
                out.m[i][j] = 0;
                for (int k = 0; k < 4; ++k) out.m[i][j] += a.m[i][k] * b.m[k][j];
            }
        return out;
    }
    Vec3d row(int i) const { return {m[i][0], m[i][1], m[i][2]}; }
    void set_row(int i, const Vec3d& x) { m[i][0] = x.x, m[i][1] = x.y, m[i][2] = x.z; }
    // Of a point; of rows that are affine.
    Vec3d operator()(const Vec3d& p) const { return p.x * row(0) + p.y * row(1) + p.z * row(2) + row(3); }
    // Of the upper three rows and columns; negative: it mirrors.
    double determinant() const { return dot(row(0), cross(row(1), row(2))); }
    // Of an affine one whose determinant is not 0.
    RowMatrix inverse() const {
        const double scale = 1 / determinant();
        const Vec3d columns[3] = {cross(row(1), row(2)), cross(row(2), row(0)), cross(row(0), row(1))};
        RowMatrix out;
        for (int j = 0; j < 3; ++j)
            out.m[0][j] = scale * columns[j].x, out.m[1][j] = scale * columns[j].y,
            out.m[2][j] = scale * columns[j].z;
        out.set_row(3, -out(row(3)));
        return out;
    }
};

inline RowMatrix row_matrix_of(const Quatd& q) {
    RowMatrix out;
    out.set_row(0, rotate(q, Vec3d{1, 0, 0}));
    out.set_row(1, rotate(q, Vec3d{0, 1, 0}));
    out.set_row(2, rotate(q, Vec3d{0, 0, 1}));
    return out;
}

}  // namespace wetcurl
