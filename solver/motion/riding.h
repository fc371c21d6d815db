// Roots that ride on a mesh that deforms: each is bound to the triangle nearest to it at rest, and moves and
// turns with that triangle.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include "base/vec3.h"
#include "solver/motion/deformation.h"

namespace wetcurl {

class RidingRoots {
  public:
    // Poses (root), and what computing them needs; memory is used again.
    struct Room {
        std::vector<Pose> pose;
        std::vector<Vec3d> vertices;
    };

    // Binds roots (root) [m], given in the frame of the mesh at rest.
    RidingRoots(std::shared_ptr<const Deformation> mesh, const std::vector<Vec3d>& roots);

    // From rest to `time` [s], with the frame of the mesh at `frame`: a root's own place at rest goes to the
    // place of its triangle's material point, plus the offset from there, which turns with the triangle and
    // grows with the square root of its area. The rotation is the one nearest to the triangle's deformation.
    void poses_at(double time, const Pose& frame, Room& room) const;
    // The rigid motion nearest to those of roots [m] that are somewhere at rest, `root(k)`.
    template <class Root>
    static Pose middle_of(const std::vector<Pose>& poses, Root root);
    // The same of roots all over the groom; `kept` leaves it as it is.
    Pose middle_at(double time, const Pose& frame, Room& room) const;

    // Poses at `share` 0 to 1 of the way from rest to `room`: those in the frame of `there`, a middle, go
    // straight, and are then moved by `frame`.
    void lead(double share, const Pose& there, const Pose& frame, Room& room) const;

    // Of these roots alone.
    RidingRoots kept(const std::vector<int>& roots) const;
    size_t count() const { return roots_.bound.size(); }

  private:
    // A triangle seen along its first edge.
    struct Facet {
        Quatd frame;                 // first axis along that edge, third along the normal
        double edge, along, across;  // [m] that edge; the other one from its corner along it, and across it
    };
    struct Bound {
        std::array<int, 3> corner;  // places in Bindings::vertices
        Vec3d weight;               // barycentric
        Vec3d root, offset;         // [m] at rest: the root, and the way to it from the mesh
        Facet rest;
    };
    struct Bindings {
        std::vector<Bound> bound;
        std::vector<int> vertices;  // of the mesh: those that they see

        Bindings kept(const std::vector<int>& which) const;
        void poses(const Deformation& mesh, double time, const Pose& frame, Room& room) const;
    };
    static Facet facet_of(const Vec3d& a, const Vec3d& b, const Vec3d& c);
    static Pose pose_of(const Bound& bound, const std::vector<Vec3d>& vertices, const Pose& frame);

    std::shared_ptr<const Deformation> mesh_;
    Bindings roots_;    // (root)
    Bindings samples_;  // some of the whole groom
};

template <class Root>
Pose RidingRoots::middle_of(const std::vector<Pose>& poses, Root root) {
    const Quatd& first = poses[0].rotation;
    Quatd sum{0, 0, 0, 0};
    Vec3d rest{0, 0, 0}, now{0, 0, 0};
    for (size_t k = 0; k < poses.size(); ++k) {
        const Quatd& q = poses[k].rotation;
        // Of the two quaternions of a rotation, that on the side of the first.
        const double side = q.w * first.w + q.x * first.x + q.y * first.y + q.z * first.z < 0 ? -1 : 1;
        sum = {sum.w + side * q.w, sum.x + side * q.x, sum.y + side * q.y, sum.z + side * q.z};
        const Vec3d at_rest = root(k);
        rest += at_rest, now += poses[k](at_rest);
    }
    const Quatd rotation = normalized(sum);
    const double share = 1 / double(poses.size());
    return {rotation, share * now - rotate(rotation, share * rest)};
}

}  // namespace wetcurl
