// Frames of an animated mesh in a file of another program, or in numbered files. They are read one by one as
// they are asked for.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "base/exchange/scene_file.h"
#include "base/geometry/mesh.h"

namespace wetcurl {

// In the file's own unit and axes.
class MeshFrames {
  public:
    virtual ~MeshFrames() = default;
    // [s] of the file's own clock, growing; numbered files have number / fps.
    const std::vector<double>& times() const { return times_; }
    const std::vector<std::array<int, 3>>& triangles() const { return triangles_; }
    const FileAxes& axes() const { return axes_; }
    // (vertex). Throws Error, with file and frame, for a frame that cannot be read or has other triangles.
    virtual std::vector<Vec3f> vertices(size_t frame) const = 0;
    // "body.abc at 0.5 s", "body.0012.obj".
    virtual std::string name_of(size_t frame) const = 0;

  protected:
    std::vector<double> times_;
    std::vector<std::array<int, 3>> triangles_;
    FileAxes axes_;
};

// Whether a path names frames: by its ending (.abc, .usda), or by a run of # in the place of a number.
bool names_frames(const std::string& path);

// `object`: the path of one mesh in the file, as "/body/skin", or of a group of them; "": all of them as one.
// Throws Misuse where no file has such a name or no mesh such a path (the text lists those that are there),
// Error for bad data, and for meshes whose times differ.
std::unique_ptr<MeshFrames> open_mesh_frames(const std::string& path, const std::string& object, double fps);

}  // namespace wetcurl
