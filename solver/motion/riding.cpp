// Binding roots to triangles, and their poses.
#include "solver/motion/riding.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace wetcurl {

namespace {

// The rotation whose axes are these, orthonormal and right-handed. Shepperd 1978: by the largest of four
// squares, so that none of them cancels.
Quatd rotation_to(const Vec3d& x, const Vec3d& y, const Vec3d& z) {
    const double squares[] = {x.x + y.y + z.z, x.x - y.y - z.z, y.y - x.x - z.z, z.z - x.x - y.y};
    const long largest = std::max_element(std::begin(squares), std::end(squares)) - std::begin(squares);
    const double r = std::sqrt(1 + squares[largest]), s = 0.5 / r;
    switch (largest) {
        case 0:
            return {0.5 * r, s * (y.z - z.y), s * (z.x - x.z), s * (x.y - y.x)};
        case 1:
            return {s * (y.z - z.y), 0.5 * r, s * (y.x + x.y), s * (z.x + x.z)};
        case 2:
            return {s * (z.x - x.z), s * (y.x + x.y), 0.5 * r, s * (z.y + y.z)};
        default:
            return {s * (x.y - y.x), s * (z.x + x.z), s * (z.y + y.z), 0.5 * r};
    }
}

Vec3d at(const Vec3d& weight, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    return weight.x * a + weight.y * b + weight.z * c;
}

// Every k-th root, so many at most: enough for the mean of a head.
std::vector<int> evenly(size_t count, size_t most) {
    std::vector<int> out;
    const size_t step = std::max<size_t>(1, (count + most - 1) / most);
    for (size_t k = 0; k < count; k += step) out.push_back(int(k));
    return out;
}

}  // namespace

RidingRoots::Facet RidingRoots::facet_of(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const Vec3d ab = b - a, ac = c - a;
    // A triangle without area keeps some frame along its edge.
    const Vec3d x = normalized(ab, Vec3d{1, 0, 0}), any = normalized(any_perpendicular(x), Vec3d{0, 1, 0}),
                z = normalized(cross(x, ac), any), y = cross(z, x);
    return {rotation_to(x, y, z), norm(ab), dot(ac, x), dot(ac, y)};
}

Pose RidingRoots::pose_of(const Bound& b, const std::vector<Vec3d>& vertices, const Pose& frame) {
    const auto corner = [&](size_t k) { return vertices[size_t(b.corner[k])]; };
    const Facet &rest = b.rest, now = facet_of(corner(0), corner(1), corner(2));
    // In the plane, from rest: (edge, 0) and (along, across) go to those of now by [[f, g], [0, h]]. The
    // rotation nearest to that turns by atan2(-g, f + h).
    const double f = now.edge / rest.edge, h = now.across / rest.across,
                 g = (now.along - f * rest.along) / rest.across, angle = std::atan2(-g, f + h);
    const Quatd turn = normalized(now.frame * rotation_about({0, 0, 1}, angle) * conjugate(rest.frame));
    const Vec3d root =
        at(b.weight, corner(0), corner(1), corner(2)) + rotate(turn, std::sqrt(f * h) * b.offset);
    const Quatd rotation = frame.rotation * turn;
    return {rotation, frame(root) - rotate(rotation, b.root)};
}

RidingRoots::Bindings RidingRoots::Bindings::kept(const std::vector<int>& which) const {
    Bindings out;
    std::vector<int> place(vertices.size(), -1);
    for (const int k : which) {
        Bound b = bound[size_t(k)];
        for (int& corner : b.corner) {
            int& to = place[size_t(corner)];
            if (to < 0) to = int(out.vertices.size()), out.vertices.push_back(vertices[size_t(corner)]);
            corner = to;
        }
        out.bound.push_back(b);
    }
    return out;
}

void RidingRoots::Bindings::poses(const Deformation& mesh, double time, const Pose& frame, Room& room) const {
    mesh.vertices_at(time, vertices, room.vertices);
    room.pose.resize(bound.size());
#pragma omp parallel for schedule(static) if (bound.size() > 1000)
    for (size_t k = 0; k < bound.size(); ++k) room.pose[k] = pose_of(bound[k], room.vertices, frame);
}

RidingRoots::RidingRoots(std::shared_ptr<const Deformation> mesh, const std::vector<Vec3d>& roots)
    : mesh_(std::move(mesh)) {
    const Mesh rest = mesh_->rest();
    const MeshDistance surface(rest);
    Bindings all;
    all.vertices.resize(rest.vertices.size());
    std::iota(all.vertices.begin(), all.vertices.end(), 0);
    all.bound.resize(roots.size());
#pragma omp parallel for schedule(static)
    for (size_t k = 0; k < roots.size(); ++k) {
        const auto found = surface.closest(roots[k]);
        const auto& t = rest.triangles[size_t(found.triangle)];
        const auto corner = [&](size_t c) { return cast<double>(rest.vertices[size_t(t[c])]); };
        const Vec3d a = corner(0), b = corner(1), c = corner(2);
        all.bound[k] = {t, found.barycentric, roots[k], roots[k] - at(found.barycentric, a, b, c),
                        facet_of(a, b, c)};
    }
    std::vector<int> each(roots.size());
    std::iota(each.begin(), each.end(), 0);
    roots_ = all.kept(each);
    samples_ = all.kept(evenly(roots.size(), 256));
}

void RidingRoots::poses_at(double time, const Pose& frame, Room& room) const {
    roots_.poses(*mesh_, time, frame, room);
}

Pose RidingRoots::middle_at(double time, const Pose& frame, Room& room) const {
    samples_.poses(*mesh_, time, frame, room);
    return middle_of(room.pose, [&](size_t k) { return samples_.bound[k].root; });
}

void RidingRoots::lead(double share, const Pose& there, const Pose& frame, Room& room) const {
    for (size_t k = 0; k < room.pose.size(); ++k) {
        const Vec3d root = roots_.bound[k].root;
        Quatd turn = conjugate(there.rotation) * room.pose[k].rotation;
        if (turn.w < 0) turn = {-turn.w, -turn.x, -turn.y, -turn.z};
        const Vec3d place = root + share * (there.inverse(room.pose[k](root)) - root);
        turn = frame.rotation *
               normalized(Quatd{1 - share + share * turn.w, share * turn.x, share * turn.y, share * turn.z});
        room.pose[k] = {turn, frame(place) - rotate(turn, root)};
    }
}

RidingRoots RidingRoots::kept(const std::vector<int>& roots) const {
    RidingRoots out = *this;
    out.roots_ = roots_.kept(roots);
    return out;
}

}  // namespace wetcurl
