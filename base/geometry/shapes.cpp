// Triangles of the solid shapes, for drawing.
#include "base/geometry/shapes.h"

#include <numbers>

namespace wetcurl {

ShapeView view_of(const Shape& shape) {
    ShapeView view;
    if (const auto* sphere = std::get_if<Sphere>(&shape))
        view.kind = ShapeView::Kind::round, view.round = {0, sphere->radius};
    if (const auto* capsule = std::get_if<Capsule>(&shape))
        view.kind = ShapeView::Kind::round, view.round = *capsule;
    if (const auto* box = std::get_if<Box>(&shape)) view.kind = ShapeView::Kind::box, view.box = *box;
    if (const auto* level_set = std::get_if<std::shared_ptr<const LevelSet>>(&shape))
        view.kind = ShapeView::Kind::grid, static_cast<DistanceGrid&>(view.grid) = (*level_set)->grid();
    return view;
}

namespace {

Bounds around_origin(const Vec3d& half) { return {-half, half}; }
Bounds bounds_of(const Sphere& s) { return around_origin({s.radius, s.radius, s.radius}); }
Bounds bounds_of(const Capsule& c) { return around_origin({c.radius, c.half_length + c.radius, c.radius}); }
Bounds bounds_of(const Box& box) { return around_origin(box.half); }
Bounds bounds_of(const Plane&) {
    constexpr double all = std::numeric_limits<double>::infinity();
    return around_origin({all, all, all});
}
// The whole grid: beyond its border distances are upper bounds, within it the trilinear interpolant of
// something farther from the mesh than a convex box is from any of its nodes.
Bounds bounds_of(const std::shared_ptr<const LevelSet>& l) {
    const DistanceGrid g = l->grid();
    const Vec3d low = cast<double>(g.origin);
    return {low, low + double(g.spacing) * Vec3d{g.nx - 1.0, g.ny - 1.0, g.nz - 1.0}};
}

// The surface of a capsule as rings about y, from the lower pole to the upper one; a sphere where half_length
// is 0.
Mesh round_mesh(double half_length, double radius, int around) {
    struct Ring {
        double y, r;
    };
    std::vector<Ring> rings;
    const int quarter = std::max(1, around / 4);
    for (int k = 1 - quarter; k <= 0; ++k) {
        const double a = std::numbers::pi / 2 * k / quarter;
        rings.push_back({-half_length + radius * std::sin(a), radius * std::cos(a)});
    }
    for (int k = half_length > 0 ? 0 : 1; k < quarter; ++k) {
        const double a = std::numbers::pi / 2 * k / quarter;
        rings.push_back({half_length + radius * std::sin(a), radius * std::cos(a)});
    }
    Mesh mesh;
    mesh.vertices.push_back({0, float(-half_length - radius), 0});
    for (const Ring& ring : rings)
        for (int m = 0; m < around; ++m) {
            const double a = 2 * std::numbers::pi * m / around;
            mesh.vertices.push_back(
                {float(ring.r * std::sin(a)), float(ring.y), float(ring.r * std::cos(a))});
        }
    mesh.vertices.push_back({0, float(half_length + radius), 0});
    const int last = int(rings.size()) - 1, top = int(mesh.vertices.size()) - 1;
    const auto at = [around](int ring, int m) { return 1 + ring * around + m % around; };
    for (int m = 0; m < around; ++m) {
        mesh.triangles.push_back({0, at(0, m + 1), at(0, m)});
        mesh.triangles.push_back({top, at(last, m), at(last, m + 1)});
        for (int ring = 0; ring < last; ++ring) {
            mesh.triangles.push_back({at(ring, m), at(ring, m + 1), at(ring + 1, m + 1)});
            mesh.triangles.push_back({at(ring, m), at(ring + 1, m + 1), at(ring + 1, m)});
        }
    }
    return mesh;
}

Mesh triangles_of(const Sphere& s, int around) { return round_mesh(0, s.radius, around); }
Mesh triangles_of(const Capsule& c, int around) { return round_mesh(c.half_length, c.radius, around); }
Mesh triangles_of(const Plane&, int) {
    return {{{-0.5f, 0, -0.5f}, {-0.5f, 0, 0.5f}, {0.5f, 0, 0.5f}, {0.5f, 0, -0.5f}}, {{0, 1, 2}, {0, 2, 3}}};
}
Mesh triangles_of(const std::shared_ptr<const LevelSet>& l, int) { return l->mesh(); }
Mesh triangles_of(const Box& box, int) {
    Mesh mesh;
    // Corner number: bit 0 x, bit 1 y, bit 2 z; set for the high side.
    for (int corner = 0; corner < 8; ++corner)
        mesh.vertices.push_back({float(corner & 1 ? box.half.x : -box.half.x),
                                 float(corner & 2 ? box.half.y : -box.half.y),
                                 float(corner & 4 ? box.half.z : -box.half.z)});
    // Each face anticlockwise seen from outside.
    constexpr int faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                 {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& f : faces) {
        mesh.triangles.push_back({f[0], f[1], f[2]});
        mesh.triangles.push_back({f[0], f[2], f[3]});
    }
    return mesh;
}

}  // namespace

Bounds bounds_of(const Shape& shape) {
    return std::visit([](const auto& s) { return bounds_of(s); }, shape);
}

Mesh triangulated(const Shape& shape, int around) {
    return std::visit([around](const auto& s) { return triangles_of(s, std::max(3, around)); }, shape);
}

}  // namespace wetcurl
