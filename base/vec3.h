// 3-vectors, symmetric and general 3x3 matrices and unit quaternions over any scalar
// (float, double, Pack, automatic-differentiation types). SI units throughout.
#pragma once

#include "base/pack.h"

namespace wetcurl {

template <class S>
struct Vec3 {
    S x, y, z;
    WETCURL_HD friend Vec3 operator+(const Vec3& a, const Vec3& b) {
        return {a.x + b.x, a.y + b.y, a.z + b.z};
    }
    WETCURL_HD friend Vec3 operator-(const Vec3& a, const Vec3& b) {
        return {a.x - b.x, a.y - b.y, a.z - b.z};
    }
    WETCURL_HD friend Vec3 operator-(const Vec3& a) { return {-a.x, -a.y, -a.z}; }
    WETCURL_HD friend Vec3 operator*(const S& s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
    WETCURL_HD Vec3& operator+=(const Vec3& b) {
        x += b.x;
        y += b.y;
        z += b.z;
        return *this;
    }
    WETCURL_HD Vec3& operator-=(const Vec3& b) {
        x -= b.x;
        y -= b.y;
        z -= b.z;
        return *this;
    }
};

template <class S>
WETCURL_HD S dot(const Vec3<S>& a, const Vec3<S>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class S>
WETCURL_HD Vec3<S> cross(const Vec3<S>& a, const Vec3<S>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class S>
WETCURL_HD S norm(const Vec3<S>& a) {
    return sqrt(dot(a, a));
}
template <class M, class S>
WETCURL_HD Vec3<S> select(M m, const Vec3<S>& a, const Vec3<S>& b) {
    return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}
// Of each coordinate.
template <class S>
WETCURL_HD Vec3<S> lower(const Vec3<S>& a, const Vec3<S>& b) {
    return {minimum(a.x, b.x), minimum(a.y, b.y), minimum(a.z, b.z)};
}
template <class S>
WETCURL_HD Vec3<S> upper(const Vec3<S>& a, const Vec3<S>& b) {
    return {maximum(a.x, b.x), maximum(a.y, b.y), maximum(a.z, b.z)};
}
// a / |a|, or `otherwise` where |a| is zero for all purposes.
template <class S>
WETCURL_HD Vec3<S> normalized(const Vec3<S>& a, const Vec3<S>& otherwise) {
    S n = norm(a);
    auto good = n > S(tiny_length<S>);
    return select(good, (S(1) / maximum(n, S(tiny_length<S>))) * a, otherwise);
}
template <class S, class U>
WETCURL_HD Vec3<S> cast(const Vec3<U>& a) {
    return {S(a.x), S(a.y), S(a.z)};
}

template <class S>
WETCURL_HD void set_zero(Vec3<S>& a) {
    a.x = a.y = a.z = S(0);
}

using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;

// Symmetric 3x3 matrix, upper triangle.
template <class S>
struct Sym3 {
    S xx, xy, xz, yy, yz, zz;
    WETCURL_HD Sym3& operator+=(const Sym3& b) {
        xx += b.xx;
        xy += b.xy;
        xz += b.xz;
        yy += b.yy;
        yz += b.yz;
        zz += b.zz;
        return *this;
    }
    WETCURL_HD friend Vec3<S> operator*(const Sym3& m, const Vec3<S>& v) {
        return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
                m.xz * v.x + m.yz * v.y + m.zz * v.z};
    }
};
template <class S>
WETCURL_HD Sym3<S> identity_times(const S& s) {
    return {s, S(0), S(0), s, S(0), s};
}
template <class S>
WETCURL_HD void set_zero(Sym3<S>& m) {
    m.xx = m.xy = m.xz = m.yy = m.yz = m.zz = S(0);
}
template <class S>
WETCURL_HD void add_identity(Sym3<S>& m, const S& s) {
    m.xx += s;
    m.yy += s;
    m.zz += s;
}
// a I + b n n^T
template <class S>
WETCURL_HD Sym3<S> isotropic_plus_outer(const S& a, const S& b, const Vec3<S>& n) {
    return {a + b * n.x * n.x, b * n.x * n.y, b * n.x * n.z,
            a + b * n.y * n.y, b * n.y * n.z, a + b * n.z * n.z};
}

// a b^T of parallel a and b.
template <class S>
WETCURL_HD Sym3<S> symmetric_outer(const Vec3<S>& a, const Vec3<S>& b) {
    return {a.x * b.x, a.x * b.y, a.x * b.z, a.y * b.y, a.y * b.z, a.z * b.z};
}

// General 3x3 matrix by rows.
template <class S>
struct Mat3 {
    Vec3<S> r0, r1, r2;
    WETCURL_HD friend Vec3<S> operator*(const Mat3& m, const Vec3<S>& v) {
        return {dot(m.r0, v), dot(m.r1, v), dot(m.r2, v)};
    }
    WETCURL_HD friend Mat3 operator-(const Mat3& m) { return {-m.r0, -m.r1, -m.r2}; }
    WETCURL_HD Mat3& operator+=(const Mat3& b) {
        r0 += b.r0;
        r1 += b.r1;
        r2 += b.r2;
        return *this;
    }
    WETCURL_HD Mat3& operator-=(const Mat3& b) {
        r0 -= b.r0;
        r1 -= b.r1;
        r2 -= b.r2;
        return *this;
    }
};
// to = from, row by row: of packs, a copy of the whole is a call of memcpy.
template <class S>
WETCURL_HD void assign(Mat3<S>& to, const Mat3<S>& from) {
    to.r0 = from.r0, to.r1 = from.r1, to.r2 = from.r2;
}
template <class S>
WETCURL_HD void set_zero(Mat3<S>& m) {
    set_zero(m.r0), set_zero(m.r1), set_zero(m.r2);
}
template <class S>
WETCURL_HD Vec3<S> transposed_times(const Mat3<S>& m, const Vec3<S>& v) {
    return v.x * m.r0 + v.y * m.r1 + v.z * m.r2;
}
template <class S>
WETCURL_HD Mat3<S> transposed(const Mat3<S>& m) {
    return {{m.r0.x, m.r1.x, m.r2.x}, {m.r0.y, m.r1.y, m.r2.y}, {m.r0.z, m.r1.z, m.r2.z}};
}
// m + m^T
template <class S>
WETCURL_HD Sym3<S> with_transposed(const Mat3<S>& m) {
    return {m.r0.x + m.r0.x, m.r0.y + m.r1.x, m.r0.z + m.r2.x,
            m.r1.y + m.r1.y, m.r1.z + m.r2.y, m.r2.z + m.r2.z};
}
// a b^T
template <class S>
WETCURL_HD Mat3<S> outer(const Vec3<S>& a, const Vec3<S>& b) {
    return {a.x * b, a.y * b, a.z * b};
}
template <class S>
WETCURL_HD Mat3<S> to_mat3(const Sym3<S>& m) {
    return {{m.xx, m.xy, m.xz}, {m.xy, m.yy, m.yz}, {m.xz, m.yz, m.zz}};
}

// Unit quaternion: a rotation.
template <class S>
struct Quat {
    S w, x, y, z;
    WETCURL_HD static Quat identity() { return {S(1), S(0), S(0), S(0)}; }
    WETCURL_HD friend Quat operator*(const Quat& a, const Quat& b) {
        return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
                a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
    }
};
template <class S, class Mask>
WETCURL_HD Quat<S> select(const Mask& mask, const Quat<S>& a, const Quat<S>& b) {
    return {select(mask, a.w, b.w), select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}
using Quatf = Quat<float>;
using Quatd = Quat<double>;

template <class S>
WETCURL_HD Quat<S> conjugate(const Quat<S>& q) {
    return {q.w, -q.x, -q.y, -q.z};
}
// Always inline: GCC leaves it out of vector loops as programs grow.
template <class S>
[[gnu::always_inline]] WETCURL_HD inline Vec3<S> rotate(const Quat<S>& q, const Vec3<S>& v) {
    Vec3<S> u{q.x, q.y, q.z};
    Vec3<S> t = S(2) * cross(u, v);
    return v + q.w * t + cross(u, t);
}
template <class S>
WETCURL_HD Quat<S> normalized(const Quat<S>& q) {
    S s = S(1) / sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return {s * q.w, s * q.x, s * q.y, s * q.z};
}
// Of a q whose norm is 1 but for rounding: one of Newton's steps.
template <class S>
WETCURL_HD Quat<S> renormalized(const Quat<S>& q) {
    S s = S(1.5) - S(0.5) * (q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    return {s * q.w, s * q.x, s * q.y, s * q.z};
}
template <class S, class U>
WETCURL_HD Quat<S> cast(const Quat<U>& q) {
    return {S(q.w), S(q.x), S(q.y), S(q.z)};
}

// A vector perpendicular to unit n (not normalised; its length is at least 0.5).
template <class S>
WETCURL_HD Vec3<S> any_perpendicular(const Vec3<S>& n) {
    auto steep = n.x * n.x > S(0.5);
    return select(steep, Vec3<S>{-n.y, n.x, S(0)}, Vec3<S>{S(0), -n.z, n.y});
}

// Minimal rotation that turns unit a to unit b; a half turn about a perpendicular axis where they oppose.
template <class S>
WETCURL_HD Quat<S> minimal_rotation(const Vec3<S>& a, const Vec3<S>& b) {
    S c = dot(a, b);
    Vec3<S> v = cross(a, b);
    Vec3<S> p = any_perpendicular(a);
    auto opposed = c < S(Plain<S>(-1) + 4 * std::numeric_limits<Plain<S>>::epsilon());
    Quat<S> q{select(opposed, S(0), S(1) + c), select(opposed, p.x, v.x), select(opposed, p.y, v.y),
              select(opposed, p.z, v.z)};
    return normalized(q);
}

// Rotation about unit axis by an angle [rad].
inline Quatd rotation_about(const Vec3d& axis, double angle) {
    double s = std::sin(angle / 2);
    return {std::cos(angle / 2), s * axis.x, s * axis.y, s * axis.z};
}

// A rigid placement: x -> rotate(rotation, x) + translation.
struct Pose {
    Quatd rotation = Quatd::identity();
    Vec3d translation{0, 0, 0};
    WETCURL_HD Vec3d operator()(const Vec3d& x) const { return rotate(rotation, x) + translation; }
    WETCURL_HD Vec3d inverse(const Vec3d& x) const { return rotate(conjugate(rotation), x - translation); }
};

}  // namespace wetcurl
