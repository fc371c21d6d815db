// Velocities at the faces of a box of cubic cells, as any device holds them, and what a step of the air asks
// of them. The staggered places are Harlow and Welch 1965, the path backwards Stam 1999.
#pragma once

#include "base/vec3.h"

namespace wetcurl {

WETCURL_HD inline double along(const Vec3d& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

// A component lies at the lower side of its cell; there is one more of them than cells along its axis. Places
// are in cells from the box's corner, in which a velocity is u / cell.
struct StaggeredGrid {
    int cells[3];
    double cell, per_cell;    // [m], [1/m]
    Vec3d corner, wind;       // [m]; what blows outside [m/s]
    double *u[3], *pressure;  // [m/s], (z, y, x) at the faces of each axis; times dt over density, at cells

    // Faces of the component `axis` along an axis.
    WETCURL_HD int faces(int axis, int a) const { return cells[a] + (a == axis); }
    // Whole numbers of 32 bits hold them: a device is slow with longer ones.
    WETCURL_HD int faces(int axis) const { return faces(axis, 0) * faces(axis, 1) * faces(axis, 2); }
    WETCURL_HD int index(int axis, int i, int j, int k) const {
        return (k * faces(axis, 1) + j) * faces(axis, 0) + i;
    }
    // The centre of a face, in cells.
    WETCURL_HD Vec3d center(int axis, int i, int j, int k) const {
        return {i + (axis == 0 ? 0 : 0.5), j + (axis == 1 ? 0 : 0.5), k + (axis == 2 ? 0 : 0.5)};
    }
    WETCURL_HD Vec3d place(int axis, int i, int j, int k) const {  // [m]
        return corner + cell * center(axis, i, j, k);
    }
    WETCURL_HD Vec3d in_cells(const Vec3d& x) const { return per_cell * (x - corner); }
    // Written so that NaN is outside.
    WETCURL_HD bool inside(const Vec3d& c) const {
        return c.x >= 0 && c.x <= cells[0] && c.y >= 0 && c.y <= cells[1] && c.z >= 0 && c.z <= cells[2];
    }

    // Eight faces around a place and their weights.
    struct Stencil {
        int corner, step[3];
        double t[3];
        // f(face, weight) for each.
        template <class F>
        WETCURL_HD void for_each(F f) const {
            for (int c = 0; c < 8; ++c) {
                int at = corner;
                double weight = 1;
                for (int a = 0; a < 3; ++a) {
                    const bool upper = (c >> a) & 1;
                    at += upper ? step[a] : 0;
                    weight *= upper ? t[a] : 1 - t[a];
                }
                f(at, weight);
            }
        }
    };
    // Of a place inside the box; within half a cell of its surface the last face's value holds.
    WETCURL_HD Stencil stencil(int axis, const Vec3d& place) const {
        Stencil s{0, {1, faces(axis, 0), faces(axis, 0) * faces(axis, 1)}, {}};
        for (int a = 0; a < 3; ++a) {
            const int n = faces(axis, a);
            const double g = minimum(maximum(along(place, a) - (a == axis ? 0 : 0.5), 0.0), double(n - 1));
            const int i = int(g) < n - 2 ? int(g) : n - 2;
            s.corner += i * s.step[a];
            s.t[a] = g - i;
        }
        return s;
    }
    WETCURL_HD double sample(int axis, const Vec3d& place) const {
        const Stencil s = stencil(axis, place);
        const double* v = u[axis] + s.corner;
        auto mix = [](double a, double b, double t) { return a + t * (b - a); };
        auto line = [&](const double* w) { return mix(w[0], w[1], s.t[0]); };
        auto plane = [&](const double* w) { return mix(line(w), line(w + s.step[1]), s.t[1]); };
        return mix(plane(v), plane(v + s.step[2]), s.t[2]);
    }
    WETCURL_HD Vec3d velocity(const Vec3d& place) const {
        if (!inside(place)) return wind;
        return {sample(0, place), sample(1, place), sample(2, place)};
    }
    WETCURL_HD Vec3d at(const Vec3d& x) const { return velocity(in_cells(x)); }

    // What a face takes on in `step` [s/m, dt / cell]: the value from where its air was, by the midpoint
    // rule.
    WETCURL_HD double advected(int axis, int i, int j, int k, double step) const {
        const Vec3d x = center(axis, i, j, k);
        const Vec3d middle = x - (step / 2) * velocity(x);
        const Vec3d from = x - step * velocity(middle);
        return inside(from) ? sample(axis, from) : along(wind, axis);
    }
    WETCURL_HD double divergence(int i, int j, int k) const {  // [1/s]
        return per_cell *
               (u[0][index(0, i + 1, j, k)] - u[0][index(0, i, j, k)] + u[1][index(1, i, j + 1, k)] -
                u[1][index(1, i, j, k)] + u[2][index(2, i, j, k + 1)] - u[2][index(2, i, j, k)]);
    }
    // What a face loses to the pressure, which is zero on the surface, half a cell from the last centre.
    WETCURL_HD double pressure_gradient(int axis, int i, int j, int k) const {
        const int at = axis == 0 ? i : axis == 1 ? j : k;
        const int row = cells[0], layer = row * cells[1], back = axis == 0 ? 1 : axis == 1 ? row : layer;
        const double* here = pressure + (k * layer + j * row + i);
        const double before = at == 0 ? 0 : *(here - back), after = at == cells[axis] ? 0 : *here;
        return (at == 0 || at == cells[axis] ? 2 : 1) * per_cell * (after - before);
    }
};

// A ball that blows, at the moment: the share of its velocity that the air at x takes on, but for the gust.
WETCURL_HD inline double share_of_ball(const Vec3d& center, double radius, const Vec3d& x) {
    const Vec3d d = x - center;
    const double inside = maximum(0.0, 1 - dot(d, d) / (radius * radius));
    return inside * (2 - inside);
}

// The air u, of one axis, once the ball's velocity v there has blown for a step.
WETCURL_HD inline double blown(double u, double gust, double share, double v) {
    return u + gust * share * (v - u);
}
// Once hair has braked it, implicitly, so that hair never takes the air beyond its own velocity: k = dt drag
// / (density volume) of the hair around a face, kv the same by its velocity.
WETCURL_HD inline double braked(double u, double k, double kv) { return (u + kv) / (1 + k); }

// Backward Euler of diffusion along a row of n faces, no flux at its ends: (1 + 2a) w_i - a w_{i-1} - a
// w_{i+1} = u_i, with 1 + a at the ends. Eliminated upwards, then substituted downwards.
WETCURL_HD inline double eliminated(double u, double before, double a, double factor) {
    return (u + a * before) * factor;
}
WETCURL_HD inline double substituted(double w, double after, double a, double factor) {
    return w + a * factor * after;
}
// Inverses of the pivots.
inline void diffusion_factors(int n, double a, double* factor) {
    for (int i = 0; i < n; ++i) {
        const double diagonal = 1 + (i == 0 || i == n - 1 ? a : 2 * a);
        factor[i] = 1 / (diagonal - (i == 0 ? 0 : a * a * factor[i - 1]));
    }
}

}  // namespace wetcurl
