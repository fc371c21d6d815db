// Balls and meshes that strands stand on.
#include "solver/grooms/scalp.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace wetcurl {

static Vec3d area_vector(const Mesh& mesh, const std::array<int, 3>& t) {
    const Vec3d a = cast<double>(mesh.vertices[size_t(t[0])]), b = cast<double>(mesh.vertices[size_t(t[1])]),
                c = cast<double>(mesh.vertices[size_t(t[2])]);
    return 0.5 * cross(b - a, c - a);
}

// The volume that the triangles enclose, seen from the middle of their box: negative where they are turned
// inward.
static double signed_volume(const Mesh& mesh) {
    const Bounds box = bounding_box(mesh);
    const Vec3d middle = 0.5 * (box.low + box.high);
    double volume = 0;
    for (const auto& t : mesh.triangles)
        volume += dot(area_vector(mesh, t), cast<double>(mesh.vertices[size_t(t[0])]) - middle) / 3;
    return volume;
}

static std::vector<Vec3d> outward_normals(const Mesh& mesh) {
    std::vector<Vec3d> normals(mesh.vertices.size(), Vec3d{0, 0, 0});
    const double sign = signed_volume(mesh) < 0 ? -1 : 1;
    for (const auto& t : mesh.triangles)
        for (int corner : t) normals[size_t(corner)] += sign * area_vector(mesh, t);
    for (auto& n : normals) n = normalized(n, Vec3d{0, 1, 0});
    return normals;
}

ScalpMesh::ScalpMesh(Mesh mesh)
    : mesh_(std::move(mesh)), box_(bounding_box(mesh_)), distance_(mesh_), normals_(outward_normals(mesh_)) {}

ScalpPoint ScalpMesh::closest(const Vec3d& x) const {
    const auto found = distance_.closest(x);
    const auto& t = mesh_.triangles[size_t(found.triangle)];
    const Vec3d w = found.barycentric;
    const Vec3d n =
        w.x * normals_[size_t(t[0])] + w.y * normals_[size_t(t[1])] + w.z * normals_[size_t(t[2])];
    const Vec3d normal = normalized(n, Vec3d{0, 1, 0});
    // Behind the rim of an open mesh a point may lie behind its closest triangle and yet outside.
    const bool below = dot(x - found.point, normal) < 0 && distance_.inside(x);
    return {found.point, normal, below ? -found.distance : found.distance};
}

ScalpPoint ScalpMesh::outermost(const Vec3d& centre, const Vec3d& direction, double radius) const {
    const Vec3d reach{std::max(box_.high.x - centre.x, centre.x - box_.low.x),
                      std::max(box_.high.y - centre.y, centre.y - box_.low.y),
                      std::max(box_.high.z - centre.z, centre.z - box_.low.z)};
    // From outside inward, each time by the distance to the mesh: no surface is stepped over.
    constexpr double touching = 1e-6;  // [m]
    constexpr int most_steps = 500;
    double t = norm(reach);
    for (int step = 0; step < most_steps && t > 0; ++step) {
        const Vec3d x = centre + t * direction;
        const double distance = distance_.closest(x).distance;
        if (distance < touching) return closest(x);
        t -= distance;
    }
    return closest(centre + radius * direction);
}

Planar square_to_disk(double u, double v) {
    const double a = 2 * u - 1, b = 2 * v - 1;
    if (a == 0 && b == 0) return {0, 0};
    constexpr double quarter = std::numbers::pi / 4;
    const bool wide = std::abs(a) > std::abs(b);
    const double r = wide ? a : b, angle = wide ? quarter * (b / a) : 2 * quarter - quarter * (a / b);
    return {r * std::cos(angle), r * std::sin(angle)};
}

// `angle` from the pole, toward a unit vector across it.
Vec3d Cap::at(double angle, const Vec3d& toward) const {
    return std::cos(angle) * pole + std::sin(angle) * toward;
}

double Cap::coverage_toward(const Vec3d& toward) const {
    if (!rim) return coverage;
    double within = 0, beyond = std::numbers::pi;
    for (int halving = 0; halving < 50; ++halving) {
        const double middle = (within + beyond) / 2;
        const Vec3d x = at(middle, toward);
        (std::acos(std::clamp(x.y, -1.0, 1.0)) < rim(x) ? within : beyond) = middle;
    }
    return within;
}

Vec3d Cap::direction(double u, double v) const {
    const Planar d = square_to_disk(u, v);
    const double r = std::min(1.0, std::hypot(d.x, d.y));
    if (r == 0) return pole;
    // Lambert: a circle of radius r on the disk bounds r^2 of the cap's area, and area runs with 1 - cos.
    const Vec3d forward = cross(pole, right);
    const double covered = rim ? coverage_toward((d.x / r) * right + (d.y / r) * forward) : coverage;
    const double c = 1 - r * r * (1 - std::cos(covered)), s = std::sqrt(std::max(0.0, 1 - c * c));
    return c * pole + (s * d.x / r) * right + (s * d.y / r) * forward;
}

ScalpPoint Scalp::root(const Vec3d& direction) const {
    if (mesh_) return mesh_->outermost(centre_, direction, radius_);
    return {centre_ + radius_ * direction, direction};
}

ScalpPoint Scalp::under(const Vec3d& x) const {
    if (mesh_) return mesh_->closest(x);
    const Vec3d normal = normalized(x - centre_, Vec3d{0, 1, 0});
    return {centre_ + radius_ * normal, normal, norm(x - centre_) - radius_};
}

Vec3d head_centre(const Mesh& mesh, double radius) {
    const double bottom = bounding_box(mesh).high.y - radius;
    Mesh above{mesh.vertices, {}};
    for (const auto& t : mesh.triangles)
        if (std::all_of(t.begin(), t.end(),
                        [&](int v) { return double(mesh.vertices[size_t(v)].y) > bottom; }))
            above.triangles.push_back(t);
    const Bounds box = bounding_box(above.triangles.empty() ? mesh : above);
    return {0.5 * (box.low.x + box.high.x), bottom, 0.5 * (box.low.z + box.high.z)};
}

}  // namespace wetcurl
