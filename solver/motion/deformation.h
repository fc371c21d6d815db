// A mesh that deforms: keyframes of one connectivity, C1 between them as Motion is.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "base/geometry/mesh.h"
#include "base/parameters.h"
#include "solver/motion/spline.h"

namespace wetcurl {

// [[solid.mesh]].
struct MeshKeyframeTable {
    double time;
    std::string file;
    static constexpr Parameter<MeshKeyframeTable> parameters[] = {
        {KeyRow::number("time", "s", 0, 0, 1e6, "Time of the keyframe; times grow from one to the next."),
         &MeshKeyframeTable::time},
        {KeyRow::path("file", "needed",
                      "Mesh of the keyframe, .obj or .ply, with the triangles of the first."),
         &MeshKeyframeTable::file},
    };
};

class Deformation {
  public:
    // Two or more [[solid.mesh]] of a solid. `metres`: what one unit of the files is. Throws Misuse (file and
    // line) for times that do not grow, a mesh that is missing or has other triangles than the first; Error
    // for one that cannot be read.
    Deformation(const Table& solid, double metres);
    // Held before the first keyframe and after the last.
    Mesh at(double time) const;
    // Its vertices [m]; allocates nothing where `out` had as many.
    void vertices_at(double time, std::vector<Vec3f>& out) const;
    // Of these vertices alone, not rounded to single precision.
    void vertices_at(double time, std::span<const int> which, std::vector<Vec3d>& out) const;
    // The shape in which hair is bound to it.
    Mesh rest() const { return at(0); }
    // Holds the mesh at all times [m]: no vertex goes beyond its keyframes.
    Bounds box() const;

  private:
    struct Key {
        double time;                  // [s]
        std::vector<Vec3f> vertices;  // (vertex) [m]
        std::vector<Vec3f> slopes;    // (vertex) [m/s]
    };
    // Between two keys, or at one of them.
    struct Place {
        const Key& from;
        const Key* to;  // null: at `from`
        HermiteWeights w;
        Vec3d vertex(size_t v) const;
    };
    Place place_of(double time) const;

    std::vector<std::array<int, 3>> triangles_;
    std::vector<Key> keys_;
};

// The mesh of `file`, which the key `file` of a table names; throws Misuse where there is none.
Mesh mesh_of(const Table& table, const std::string& file, double metres);

}  // namespace wetcurl
