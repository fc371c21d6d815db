// Triangle meshes: reading, closest point and winding number over one bounding-volume hierarchy.
// Closest point: Ericson 2005, 5.1.5. Winding number: Jacobson 2013, Eq 5; far clusters as dipoles: Barill
// 2018.
#pragma once

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/vec3.h"

namespace wetcurl {

struct Mesh {
    std::vector<Vec3f> vertices;                // (vertex) [m]
    std::vector<std::array<int, 3>> triangles;  // (triangle, corner): indices of vertices
};

// Reads .obj, or .ply (ascii, binary little-endian); polygons are fanned from their first corner.
// `scale_to_metres`: what one unit of the file is (0.01 for centimetres).
// Throws Error, with file and line or element, for a file that is missing, empty, cut short, foreign, has
// absurd counts, numbers that are not finite, or indices out of range.
Mesh read_mesh(const std::string& path, double scale_to_metres);

// Edges that belong to one triangle only: 0 for a closed mesh.
int boundary_edges(const Mesh& mesh);

struct Bounds {
    Vec3d low, high;
};
// Of the vertices that a triangle uses [m].
Bounds bounding_box(const Mesh& mesh);

// Exact distance to a mesh. Keeps a copy of what it needs of it. Const functions may run in parallel.
class MeshDistance {
  public:
    // Throws Error where no triangle has an area; those that have none are left out.
    explicit MeshDistance(const Mesh& mesh);

    struct Closest {
        double distance = std::numeric_limits<double>::infinity();  // [m], never negative
        Vec3d point{0, 0, 0};                                       // on the mesh
        int triangle = -1;                                          // of the mesh
        Vec3d barycentric{1, 0, 0};                                 // weights of its corners: ≥ 0, sum 1
    };
    // `guess`, a triangle thought to be near (the last answer nearby), shortens the search; the distance does
    // not depend on it.
    Closest closest(const Vec3d& x, int guess = -1) const;
    // How often the mesh wraps round x: 1 inside a closed mesh whose corners turn anticlockwise seen from
    // outside, 0 outside, between them near a hole. Dipoles stand for clusters, error about 0.02 a surface.
    double winding_number(const Vec3d& x) const;
    // Inside by the winding number, whichever way the triangles are turned.
    bool inside(const Vec3d& x) const { return std::abs(winding_number(x)) > 0.5; }

  private:
    struct Triangle {
        Vec3d a, b, c;
    };
    struct Node {
        Vec3d low, high;     // box
        Vec3d centre, area;  // dipole: area-weighted centroid, sum of area vectors [m^2]
        double radius;       // of the ball about `centre` that holds the triangles [m]
        int first, count;    // leaf: its triangles; else count = 0, children at `first` and `first` + 1
    };
    void build(int node, int first, int count, const std::vector<Triangle>& given);
    static Node summary(const std::vector<int>& members, const std::vector<Triangle>& given);

    std::vector<Triangle> triangles_;  // in the order of the leaves
    std::vector<int> original_;        // index in the mesh of each of them
    std::vector<int> place_;           // its inverse; -1: left out
    std::vector<Node> nodes_;
};

}  // namespace wetcurl
