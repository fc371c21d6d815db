// A mesh that deforms: keyframes of one connectivity, from files of their own or from a file of another
// program, C1 between them as Motion is.
#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <vector>

#include "base/geometry/file_frame.h"
#include "base/geometry/mesh_winding.h"
#include "base/parameters.h"
#include "solver/motion/cuts.h"
#include "solver/motion/mesh_frames.h"
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
                      "Mesh of the keyframe, .obj, .ply or .glb, with the triangles of the first."),
         &MeshKeyframeTable::file},
    };
};

class Deformation {
  public:
    // Two or more [[solid.mesh]] of a solid, placed by `frame`. Throws Misuse (file and line) for times that
    // do not grow, a mesh that is missing or has other triangles than the first; Error for one that cannot be
    // read.
    Deformation(const Table& solid, const FileFrame& frame);
    // Frames of a file, of which few are in memory at a time. `begin` [s]: of the file's clock, time 0 here.
    // Const functions throw Error for a frame that cannot be read.
    Deformation(std::unique_ptr<const MeshFrames> frames, const FileFrame& frame, double begin);

    // One that a caller drives: it stands as `mesh` [m] until then, and hair is bound to it so.
    explicit Deformation(Mesh mesh);
    // Its vertices [m] at the time `end` [s], from where and as fast as they are at the end of the last span.
    void go_to(double end, std::vector<Vec3f> vertices);
    // They rest there from `time` on.
    void jump_to(double time, std::vector<Vec3f> vertices);

    // Held before the first keyframe and after the last.
    Mesh at(double time) const;
    // Its vertices [m]; allocates nothing where `out` had as many, and no frame is read.
    void vertices_at(double time, std::vector<Vec3f>& out) const;
    // Of these vertices alone, not rounded to single precision.
    void vertices_at(double time, std::span<const int> which, std::vector<Vec3d>& out) const;

    // The shape in which hair is bound to it: one of its own, else the one at time 0. Throws Error where the
    // other has other triangles.
    Mesh rest() const { return rest_ ? *rest_ : at(0); }
    void rest_as(Mesh mesh, const std::string& file);
    // Turns the triangles alike, by the first keyframe; after `rest_as`.
    void wind(Winding& found);
    // It comes to rest at keyframes on either side of these cuts.
    void rest_at(const ShotCuts& cuts);

    const std::vector<double>& times() const { return times_; }  // [s] of keyframes
    bool reads_frames() const { return frames_ != nullptr; }     // of a file, one by one
    size_t frames_in_memory() const { return near_.size(); }
    // Holds the mesh from one time to the other [m]: no vertex goes beyond its keyframes. Each of them is
    // read.
    Bounds box(double from = -1e300, double to = 1e300) const;

  private:
    using Vertices = std::vector<Vec3f>;  // (vertex) [m]
    struct Key {
        std::shared_ptr<const Vertices> vertices;
        Vertices slopes;  // (vertex) [m/s]
    };
    // Between two keys, or at one of them.
    struct Place {
        std::shared_ptr<const Key> from, to;  // the second is null at a key
        HermiteWeights w;
        Vec3d vertex(size_t v) const;
    };
    Place place_of(double time) const;
    std::shared_ptr<const Key> key(size_t k) const;
    std::shared_ptr<const Vertices> vertices_of(size_t k) const;
    std::shared_ptr<const Key> key_of_neighbours(size_t k) const;

    std::vector<std::array<int, 3>> triangles_;
    std::vector<double> times_;
    ShotCuts cuts_;
    std::shared_ptr<const Mesh> rest_;
    // Of frames in a file those around the one asked for last, of keyframes in files of their own all.
    std::unique_ptr<const MeshFrames> frames_;
    FileFrame frame_;
    mutable std::mutex mutex_;
    mutable std::map<size_t, std::shared_ptr<const Vertices>> near_;
    mutable std::map<size_t, std::shared_ptr<const Key>> keys_;
};

// The mesh of `file`, which the key `file` of a table names, `metres` each of its units; throws Misuse where
// there is none.
Mesh mesh_of(const Table& table, const std::string& file, double metres);

}  // namespace wetcurl
