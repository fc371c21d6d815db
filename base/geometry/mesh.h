// Triangle meshes: reading, closest point and winding number over one bounding-volume hierarchy.
// Winding number: Jacobson 2013, Eq 5.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/geometry/triangle_tree.h"

namespace wetcurl {

struct Mesh {
    std::vector<Vec3f> vertices;                // (vertex) [m]
    std::vector<std::array<int, 3>> triangles;  // (triangle, corner): indices of vertices
};

// Reads .obj, .glb, or .ply (ascii, binary little-endian); polygons are fanned from their first corner.
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
    explicit MeshDistance(const Mesh& mesh) { rebuild(mesh); }
    // Of another mesh, or one that moved; memory is kept.
    void rebuild(const Mesh& mesh);

    // As TriangleTree's.
    using Closest = TriangleTree::Closest;
    Closest closest(const Vec3d& x, int guess = -1) const;
    double winding_number(const Vec3d& x) const;
    bool inside(const Vec3d& x) const;
    size_t bytes() const;
    // Valid until it is rebuilt.
    TriangleTree tree() const { return {triangles_, original_, place_, nodes_}; }

  private:
    using Triangle = TriangleTree::Triangle;
    using Node = TriangleTree::Node;
    // A triangle as building asks for it time and again.
    struct Given {
        Triangle corners;
        Vec3d centroid, area;  // area vector [m^2]
        double size;           // its length
        bool counts;           // one without an area has no surface to be near to, and no weights
    };
    void build(int node, int first, int count, int& used);
    Node summary(std::span<const int> members) const;

    std::vector<Given> given_;
    // What the tree views.
    std::vector<Triangle> triangles_;
    std::vector<int> original_, place_;
    std::vector<Node> nodes_;
};

}  // namespace wetcurl
