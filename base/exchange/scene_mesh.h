// The meshes of a scene file as one mesh, and meshes of any file as they first stand in it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/exchange/scene_file.h"
#include "base/geometry/mesh.h"

namespace wetcurl {

// In the file's own unit and axes. Samples are read as they are asked for.
class SceneMesh {
  public:
    // `object`: the path of one mesh in the file, as "/body/skin", or of a group of them; "": all of them;
    // chosen_objects says which.
    // Throws Misuse where the file has no such object (the text lists those that are there), Error for bad
    // data, a file without a mesh, and meshes whose times differ.
    SceneMesh(const std::string& path, const std::string& object);
    const FileAxes& axes() const { return file_->axes(); }
    const std::vector<double>& times() const { return times_; }  // (sample) [s] of the file's clock
    const std::vector<std::array<int, 3>>& triangles() const { return triangles_; }
    // (vertex). Throws Error, with file and sample, for one that cannot be read.
    std::vector<Vec3f> vertices(size_t sample) const;

  private:
    std::unique_ptr<SceneReader> file_;
    std::vector<size_t> objects_;
    std::vector<double> times_;
    std::vector<std::array<int, 3>> triangles_;
};

// The mesh of a file in its own unit and axes: .obj, .ply, .glb, or what an .abc or .usda holds at its first
// time: its only mesh, or of more `object`, as above. Throws as read_mesh and SceneMesh do.
Mesh first_mesh(const std::string& path, const std::string& object = "");
// What such a file says of them.
FileAxes axes_of_mesh(const std::string& path);

}  // namespace wetcurl
