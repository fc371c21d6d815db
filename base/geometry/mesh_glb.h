// Meshes of .glb files, as Blender and other programs write them.
#pragma once

#include <string>

#include "base/geometry/mesh.h"

namespace wetcurl {

// In metres, Y up, as glTF prescribes. `path` is for messages. Throws Error for bad or compressed data.
Mesh mesh_of_glb(const std::string& bytes, const std::string& path);

}  // namespace wetcurl
