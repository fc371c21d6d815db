// What strands stand on: a ball or a head's mesh, with its height and outward normal.
// The map of the square to the cap: Shirley 1997 (concentric squares to the disk), Lambert (disk to sphere);
// both keep area ratios, so an even grid gives even hair.
#pragma once

#include <memory>

#include "base/geometry/mesh.h"
#include "solver/grooms/planar.h"

namespace wetcurl {

// A point of the scalp under or over some x.
struct ScalpPoint {
    Vec3d place;        // on the scalp [m]
    Vec3d normal;       // unit, outward
    double height = 0;  // of x over the scalp [m], negative below it
};

// A mesh with normals that vary smoothly over it, and its closest points. Const functions may run in
// parallel.
class ScalpMesh {
  public:
    // Normals are turned outward whichever way the triangles run. Throws Error for a mesh without area.
    explicit ScalpMesh(Mesh mesh);
    ScalpPoint closest(const Vec3d& x) const;
    // Where the ray from `centre` along unit `direction` leaves the mesh for the last time; where it meets
    // nothing (a hole), the point closest to the ray's point at `radius`.
    ScalpPoint outermost(const Vec3d& centre, const Vec3d& direction, double radius) const;
    const Mesh& mesh() const { return mesh_; }
    const MeshDistance& distance() const { return distance_; }

  private:
    Mesh mesh_;
    Bounds box_;
    MeshDistance distance_;
    std::vector<Vec3d> normals_;  // (vertex), unit, area-weighted
};

// Uniform area: unit square to unit disk, (0.5, 0.5) to the middle.
Planar square_to_disk(double u, double v);

// Directions about `pole`, out to the rim. x of the disk runs along `right`.
struct Cap {
    Vec3d pole, right;  // unit, perpendicular
    double coverage;    // [rad] from the pole to the rim
    // In its place, where given: the angle from straight up [rad] at which the cap ends in the direction
    // given.
    double (*rim)(const Vec3d& direction) = nullptr;
    // Unit direction of a place of the unit square; with a rim that is a circle, equal areas of the one are
    // equal areas of the other.
    Vec3d direction(double u, double v) const;

  private:
    Vec3d at(double angle, const Vec3d& toward) const;
    double coverage_toward(const Vec3d& toward) const;
};

// A ball, or a mesh seen from a centre within it.
class Scalp {
  public:
    Scalp(Vec3d centre, double radius, std::shared_ptr<const ScalpMesh> mesh = nullptr)
        : centre_(centre), radius_(radius), mesh_(std::move(mesh)) {}
    ScalpPoint root(const Vec3d& direction) const;
    ScalpPoint under(const Vec3d& x) const;
    const Vec3d& centre() const { return centre_; }

  private:
    Vec3d centre_;
    double radius_;
    std::shared_ptr<const ScalpMesh> mesh_;
};

// Where a head's centre would be: `radius` below the top of its mesh, amid what lies above that.
Vec3d head_centre(const Mesh& mesh, double radius);

}  // namespace wetcurl
