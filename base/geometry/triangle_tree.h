// Closest point and winding number over a bounding-volume hierarchy of triangles, a view as any device walks
// it. Ericson 2005, 5.1.5; Van Oosterom and Strackee 1983, Eq 8; Barill 2018, Eq 6 (order 1).
#pragma once

#include <limits>
#include <numbers>
#include <span>

#include "base/vec3.h"

namespace wetcurl {

struct TriangleTree {
    struct Triangle {
        Vec3d a, b, c;
    };
    struct Node {
        Vec3d low, high;     // box
        Vec3d centre, area;  // dipole: area-weighted centroid, sum of area vectors [m^2]
        double radius;       // of the ball about `centre` that holds the triangles [m]
        int first, count;    // leaf: its triangles; else count = 0, children at `first` and `first` + 1
    };
    std::span<const Triangle> triangles;  // in the order of the leaves
    std::span<const int> original;        // index in the mesh of each of them
    std::span<const int> place;           // its inverse; -1: left out
    std::span<const Node> nodes;

    struct Closest {
        double distance = std::numeric_limits<double>::infinity();  // [m], never negative
        Vec3d point{0, 0, 0};                                       // on the mesh
        int triangle = -1;                                          // of the mesh
        Vec3d barycentric{1, 0, 0};                                 // weights of its corners: ≥ 0, sum 1
    };
    // `guess`, a triangle thought to be near (the last answer nearby), shortens the search; the distance does
    // not depend on it. `from`: of the guess and of what lies under this node alone.
    WETCURL_HD Closest closest(const Vec3d& x, int guess, int from = 0) const;
    // How often the mesh wraps round x: 1 inside a closed mesh whose corners turn anticlockwise seen from
    // outside, 0 outside, between them near a hole. Dipoles stand for clusters, error about 0.02 a surface.
    WETCURL_HD double winding_number(const Vec3d& x) const;
    // Inside by the winding number, whichever way the triangles are turned.
    WETCURL_HD bool inside(const Vec3d& x) const { return std::abs(winding_number(x)) > 0.5; }

  private:
    // Halving 2^31 triangles leaves fewer levels than this; a level keeps one node waiting.
    static constexpr int deepest = 32;

    WETCURL_HD static double squared_distance_to_box(const Vec3d& x, const Vec3d& low, const Vec3d& high) {
        const Vec3d d = x - lower(upper(x, low), high);
        return dot(d, d);
    }
    // Barycentric weights of the point of triangle abc nearest to x.
    WETCURL_HD static Vec3d closest_weights(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& x);
    // Of abc seen from the origin (Van Oosterom and Strackee 1983, Eq 8).
    WETCURL_HD static double solid_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c);
};

WETCURL_HD inline Vec3d TriangleTree::closest_weights(const Vec3d& a, const Vec3d& b, const Vec3d& c,
                                                      const Vec3d& x) {
    const Vec3d ab = b - a, ac = c - a, ax = x - a, bx = x - b, cx = x - c;
    const double d1 = dot(ab, ax), d2 = dot(ac, ax), d3 = dot(ab, bx), d4 = dot(ac, bx), d5 = dot(ab, cx),
                 d6 = dot(ac, cx);
    if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
    if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
    if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
    const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
    const double bc = (d4 - d3) + (d5 - d6);
    if (va <= 0 && d4 >= d3 && d5 >= d6) return {0, 1 - (d4 - d3) / bc, (d4 - d3) / bc};
    const double sum = va + vb + vc;
    return {1 - vb / sum - vc / sum, vb / sum, vc / sum};
}

WETCURL_HD inline double TriangleTree::solid_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const double la = norm(a), lb = norm(b), lc = norm(c);
    const double volume = dot(a, cross(b, c));
    // In the triangle's own plane the angle has no side.
    if (volume == 0) return 0;
    return 2 * std::atan2(volume, la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

WETCURL_HD inline TriangleTree::Closest TriangleTree::closest(const Vec3d& x, int guess, int from) const {
    double least = std::numeric_limits<double>::infinity();
    Closest best;
    const auto visit = [&](int t) {
        const auto& [a, b, c] = triangles[size_t(t)];
        const Vec3d w = closest_weights(a, b, c, x);
        const Vec3d p = w.x * a + w.y * b + w.z * c;
        if (const double d = dot(x - p, x - p); d < least) {
            least = d;
            best = {0, p, original[size_t(t)], w};
        }
    };
    if (guess >= 0 && guess < int(place.size()) && place[size_t(guess)] >= 0) visit(place[size_t(guess)]);
    struct Waiting {
        int node;
        double near;
    } stack[deepest];
    int top = 0;
    const auto waiting = [&](int n) {
        return Waiting{n, squared_distance_to_box(x, nodes[size_t(n)].low, nodes[size_t(n)].high)};
    };
    stack[top++] = waiting(from);
    while (top > 0) {
        const Waiting next = stack[--top];
        if (next.near >= least) continue;
        const Node& node = nodes[size_t(next.node)];
        for (int t = node.first; t < node.first + node.count; ++t) visit(t);
        if (node.count > 0) continue;
        const Waiting left = waiting(node.first), right = waiting(node.first + 1);
        const bool left_first = left.near < right.near;
        stack[top++] = left_first ? right : left;  // the farther one waits
        stack[top++] = left_first ? left : right;
    }
    best.distance = std::sqrt(least);
    return best;
}

WETCURL_HD inline double TriangleTree::winding_number(const Vec3d& x) const {
    // Barill 2018: a cluster seen from beyond beta times its radius is a dipole.
    constexpr double beta = 3;
    double sum = 0;
    int stack[deepest], top = 0;
    stack[top++] = 0;
    while (top > 0) {
        const Node& node = nodes[size_t(stack[--top])];
        const Vec3d d = node.centre - x;
        if (const double r2 = dot(d, d); r2 > beta * beta * node.radius * node.radius) {
            sum += dot(d, node.area) / (r2 * std::sqrt(r2));
            continue;
        }
        for (int t = node.first; t < node.first + node.count; ++t) {
            const auto& [a, b, c] = triangles[size_t(t)];
            sum += solid_angle(a - x, b - x, c - x);
        }
        if (node.count > 0) continue;
        stack[top++] = node.first;
        stack[top++] = node.first + 1;
    }
    return sum / (4 * std::numbers::pi);
}

}  // namespace wetcurl
