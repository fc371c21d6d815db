// A mesh that deforms: keyframes of one connectivity, C1 between them as Motion is.
#pragma once

#include <vector>

#include "base/config.h"
#include "base/geometry/mesh.h"

namespace wetcurl {

class Deformation {
  public:
    // [[solid.mesh]] time [s], file = "….obj" or "….ply": two or more. `metres`: what one unit of the files
    // is. Throws Misuse (file and line) for times that do not grow, a mesh that is missing or has other
    // triangles than the first; Error for one that cannot be read.
    Deformation(const Table& solid, double metres);
    // Held before the first keyframe and after the last.
    Mesh at(double time) const;
    // Its vertices [m]; allocates nothing where `out` had as many.
    void vertices_at(double time, std::vector<Vec3f>& out) const;
    // Holds the mesh at all times [m]: no vertex goes beyond its keyframes.
    Bounds box() const;

  private:
    struct Key {
        double time;                  // [s]
        std::vector<Vec3f> vertices;  // (vertex) [m]
        std::vector<Vec3f> slopes;    // (vertex) [m/s]
    };
    std::vector<std::array<int, 3>> triangles_;
    std::vector<Key> keys_;
};

// The mesh that a key `file` names; throws Misuse where there is none.
Mesh mesh_of(const Table& table, double metres);

}  // namespace wetcurl
