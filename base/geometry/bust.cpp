// The bust: its parts, and the mesh of its surface (surface nets: Gibson 1998, "Constrained elastic surface
// nets").
#include "base/geometry/bust.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace wetcurl {
namespace {

// ---- parts, at the size of a skull of 0.095 m

constexpr double skull = 0.095;

// Ellipsoid (Quilez's bound of its distance).
double ellipsoid(const Vec3d& x, const Vec3d& half) {
    const Vec3d by_half{x.x / half.x, x.y / half.y, x.z / half.z};
    const Vec3d by_square{by_half.x / half.x, by_half.y / half.y, by_half.z / half.z};
    const double a = norm(by_half), b = norm(by_square);
    return b > 0 ? a * (a - 1) / b : -std::min({half.x, half.y, half.z});
}
// From a to b, of radius `at_a` and `at_b`.
double cone(const Vec3d& x, const Vec3d& a, const Vec3d& b, double at_a, double at_b) {
    const Vec3d axis = b - a, from = x - a;
    const double t = std::clamp(dot(from, axis) / dot(axis, axis), 0.0, 1.0);
    return norm(from - t * axis) - (at_a + t * (at_b - at_a));
}
double ball(const Vec3d& x, const Vec3d& centre, double radius) { return norm(x - centre) - radius; }
// Smooth minimum, over a width `k` [m].
double joined(double a, double b, double k) {
    const double h = std::max(k - std::abs(a - b), 0.0) / k;
    return std::min(a, b) - h * h * k / 4;
}
double carved(double a, double b, double k) { return -joined(-a, b, k); }

double ear(const Vec3d& x) {
    // Turned outward from the skull, with a hollow.
    const Vec3d at = x - Vec3d{0.0765, -0.020, -0.012};
    const double c = std::cos(0.35), s = std::sin(0.35);
    const Vec3d y{c * at.x + s * at.z, at.y + 0.2 * at.z, -s * at.x + c * at.z};
    return carved(ellipsoid(y, {0.0075, 0.031, 0.018}),
                  ellipsoid(y - Vec3d{0.007, 0.003, 0.003}, {0.006, 0.017, 0.009}), 0.004);
}

double face(const Vec3d& x, const Vec3d& side) {  // side: |x| in place of x
    double d = ellipsoid(x - Vec3d{0, -0.050, 0.030}, {0.056, 0.074, 0.056});
    d = joined(d, cone(side, {0.046, -0.068, 0.004}, {0.012, -0.110, 0.058}, 0.016, 0.014), 0.030);  // jaw
    d = joined(d, ball(x, {0, -0.112, 0.064}, 0.016), 0.022);                                        // chin
    d = joined(d, ball(side, {0.040, -0.043, 0.057}, 0.018), 0.025);                                 // cheek
    d = joined(d, cone(side, {0.010, -0.004, 0.083}, {0.044, -0.006, 0.064}, 0.008, 0.008), 0.020);  // brow
    d = carved(d, ellipsoid(side - Vec3d{0.031, -0.023, 0.094}, {0.017, 0.010, 0.016}), 0.014);      // eye
    d = joined(d, ball(side, {0.030, -0.023, 0.070}, 0.0125), 0.004);
    d = joined(d, cone(x, {0, -0.014, 0.086}, {0, -0.052, 0.104}, 0.0055, 0.0085), 0.010);  // nose
    d = joined(d, ball(side, {0.0095, -0.056, 0.094}, 0.0070), 0.008);
    d = joined(d, ellipsoid(side - Vec3d{0.005, -0.0770, 0.0790}, {0.017, 0.0055, 0.0085}), 0.006);  // lips
    d = joined(d, ellipsoid(x - Vec3d{0, -0.0885, 0.0775}, {0.017, 0.0065, 0.0090}), 0.006);
    d = carved(d, ellipsoid(x - Vec3d{0, -0.0822, 0.0900}, {0.022, 0.0016, 0.0060}), 0.003);  // between them
    return d;
}

double trunk(const Vec3d& x, const Vec3d& side) {
    double d = cone(x, {0, -0.080, -0.022}, {0, -0.190, -0.036}, 0.050, 0.056);  // neck
    d = joined(d, cone(side, {0.020, -0.185, -0.046}, {0.165, -0.238, -0.036}, 0.042, 0.050),
               0.050);                                                                     // shoulder
    d = joined(d, ellipsoid(x - Vec3d{0, -0.315, -0.026}, {0.165, 0.115, 0.088}), 0.050);  // chest
    const double floor = -0.345 - x.y;
    return -joined(-d, -floor, 0.010);
}

double at_usual_size(const Vec3d& x) {
    const Vec3d side{std::abs(x.x), x.y, x.z};
    double d = ellipsoid(x - Vec3d{0, 0.004, -0.006}, {0.0770, 0.0920, 0.0960});
    d = joined(d, ellipsoid(x - Vec3d{0, -0.030, -0.045}, {0.060, 0.055, 0.050}), 0.030);  // back of the head
    d = joined(d, face(x, side), 0.030);
    d = joined(d, ear(side), 0.006);
    return joined(d, trunk(x, side), 0.022);
}

Vec3d gradient(const Vec3d& x) {
    constexpr double e = 1e-5;  // [m]
    auto along = [&](const Vec3d& step) {
        return (at_usual_size(x + step) - at_usual_size(x - step)) / (2 * e);
    };
    return {along({e, 0, 0}), along({0, e, 0}), along({0, 0, e})};
}

}  // namespace

double bust_at(const Vec3d& x, double radius) { return radius / skull * at_usual_size((skull / radius) * x); }

Mesh bust_mesh(double radius, double spacing) {
    if (spacing == 0) spacing = radius / 36;
    if (!(radius > 0 && spacing > 0)) throw Error("a bust: radius and spacing must be above 0");
    const double h = spacing * skull / radius;
    const Vec3d low{-0.235, -0.36, -0.145}, high{0.235, 0.115, 0.135};
    const int nx = int((high.x - low.x) / h) + 2, ny = int((high.y - low.y) / h) + 2,
              nz = int((high.z - low.z) / h) + 2;
    if (double(nx) * ny * nz > 1e8)
        throw Error("a bust: found a spacing of " + std::to_string(spacing) + " m, too fine for a head");
    auto node = [&](int i, int j, int k) {
        return (size_t(k) * size_t(ny) + size_t(j)) * size_t(nx) + size_t(i);
    };
    auto place = [&](int i, int j, int k) { return low + h * Vec3d{double(i), double(j), double(k)}; };
    std::vector<float> value(size_t(nx) * size_t(ny) * size_t(nz));
#pragma omp parallel for schedule(static)
    for (int k = 0; k < nz; ++k)
        for (int j = 0; j < ny; ++j)
            for (int i = 0; i < nx; ++i) value[node(i, j, k)] = float(at_usual_size(place(i, j, k)));

    // A vertex in each cell that the surface crosses, then a quad round each edge that it crosses.
    Mesh mesh;
    std::vector<int> vertex(value.size(), -1);
    for (int k = 0; k + 1 < nz; ++k)
        for (int j = 0; j + 1 < ny; ++j)
            for (int i = 0; i + 1 < nx; ++i) {
                Vec3d sum{0, 0, 0};
                int crossed = 0;
                auto edge = [&](int a, int b) {  // corners by bits: 1 x, 2 y, 4 z
                    const Vec3d pa = place(i + (a & 1), j + (a >> 1 & 1), k + (a >> 2)),
                                pb = place(i + (b & 1), j + (b >> 1 & 1), k + (b >> 2));
                    const double va = double(value[node(i + (a & 1), j + (a >> 1 & 1), k + (a >> 2))]),
                                 vb = double(value[node(i + (b & 1), j + (b >> 1 & 1), k + (b >> 2))]);
                    if ((va < 0) == (vb < 0)) return;
                    sum += pa + (va / (va - vb)) * (pb - pa);
                    ++crossed;
                };
                for (int a = 0; a < 8; ++a)
                    for (int bit : {1, 2, 4})
                        if (!(a & bit)) edge(a, a | bit);
                if (!crossed) continue;
                Vec3d x = (1.0 / crossed) * sum;
                for (int step = 0; step < 3; ++step) {  // onto the surface
                    const Vec3d g = gradient(x);
                    const double square = dot(g, g);
                    if (square > 0) x -= std::clamp(at_usual_size(x) / square, -h, h) * g;
                }
                vertex[node(i, j, k)] = int(mesh.vertices.size());
                mesh.vertices.push_back(cast<float>((radius / skull) * x));
            }
    auto quad = [&](bool inward, int a, int b, int c, int d) {
        if (inward) std::swap(b, d);
        mesh.triangles.push_back({a, b, c});
        mesh.triangles.push_back({a, c, d});
    };
    for (int k = 1; k + 1 < nz; ++k)
        for (int j = 1; j + 1 < ny; ++j)
            for (int i = 1; i + 1 < nx; ++i) {
                const bool within = value[node(i, j, k)] < 0;
                auto at = [&](int di, int dj, int dk) { return vertex[node(i - di, j - dj, k - dk)]; };
                if (within != (value[node(i + 1, j, k)] < 0))
                    quad(!within, at(0, 1, 1), at(0, 0, 1), at(0, 0, 0), at(0, 1, 0));
                if (within != (value[node(i, j + 1, k)] < 0))
                    quad(!within, at(1, 0, 1), at(1, 0, 0), at(0, 0, 0), at(0, 0, 1));
                if (within != (value[node(i, j, k + 1)] < 0))
                    quad(!within, at(1, 1, 0), at(0, 1, 0), at(0, 0, 0), at(1, 0, 0));
            }
    return mesh;
}

double hairline(const Vec3d& direction) {
    // By the angle round the head from the middle of the brow, either side: brow, temple, before the ear,
    // over it, behind it, nape [degrees].
    constexpr std::array<std::array<double, 2>, 8> ends{
        {{0, 50}, {28, 51}, {50, 60}, {72, 84}, {90, 80}, {108, 96}, {130, 118}, {180, 126}}};
    constexpr double degree = std::numbers::pi / 180;
    const double round = std::abs(std::atan2(direction.x, direction.z)) / degree;
    for (size_t k = 1; k < ends.size(); ++k)
        if (round <= ends[k][0]) {
            const double t = (round - ends[k - 1][0]) / (ends[k][0] - ends[k - 1][0]),
                         smooth = t * t * (3 - 2 * t);
            return degree * (ends[k - 1][1] + smooth * (ends[k][1] - ends[k - 1][1]));
        }
    return degree * ends.back()[1];
}

}  // namespace wetcurl
