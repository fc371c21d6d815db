// Points of a plane.
#pragma once

#include <cmath>

namespace wetcurl {

struct Planar {
    double x, y;
    friend Planar operator+(const Planar& a, const Planar& b) { return {a.x + b.x, a.y + b.y}; }
    friend Planar operator-(const Planar& a, const Planar& b) { return {a.x - b.x, a.y - b.y}; }
    friend Planar operator*(double s, const Planar& a) { return {s * a.x, s * a.y}; }
};
inline double dot(const Planar& a, const Planar& b) { return a.x * b.x + a.y * b.y; }
inline double cross(const Planar& a, const Planar& b) { return a.x * b.y - a.y * b.x; }
inline double norm(const Planar& a) { return std::hypot(a.x, a.y); }

}  // namespace wetcurl
