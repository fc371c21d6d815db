// Meshes of scene files.
#include "base/exchange/scene_mesh.h"

#include "base/error.h"
#include "base/file_ending.h"
#include "base/geometry/polygon_fan.h"

namespace wetcurl {

// The triangles of a mesh whose first vertex has the number `first`.
static void add_triangles(std::vector<std::array<int, 3>>& out, const MeshObject& mesh, int first) {
    PolygonFans fans;
    std::vector<uint64_t> keys;
    size_t corner = 0;
    for (const int count : mesh.counts) {
        keys.assign(mesh.corners.begin() + long(corner), mesh.corners.begin() + long(corner) + count);
        const int start = int(fans.start_of(keys));
        for (int c = 1; c + 1 < count; ++c) {
            const auto at = [&](int which) {
                return first + mesh.corners[corner + size_t((start + which) % count)];
            };
            const std::array<int, 3> t{at(0), at(c), at(c + 1)};
            if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) out.push_back(t);
        }
        corner += size_t(count);
    }
}

SceneMesh::SceneMesh(const std::string& path, const std::string& object) : file_(open_scene_file(path)) {
    const auto& meshes = file_->meshes();
    std::string listed;
    for (const auto& mesh : meshes) listed += "\n  " + mesh.path;
    if (meshes.empty()) throw Error(path + ": has no mesh");
    objects_ = chosen_objects(path, meshes, object, "meshes");
    if (objects_.empty()) throw Misuse(path + ": found no mesh '" + object + "'; it has" + listed);
    times_ = meshes[objects_[0]].times;
    for (const size_t k : objects_)
        if (meshes[k].times.size() > times_.size()) times_ = meshes[k].times;
    int first = 0;
    for (const size_t k : objects_) {
        const MeshObject& mesh = meshes[k];
        // What is sampled once stays as it is.
        if (mesh.times.size() > 1 && mesh.times != times_)
            throw Error(path +
                        ": the meshes are sampled at different times, so that they cannot be one; "
                        "object = \"...\" names one of" +
                        listed);
        add_triangles(triangles_, mesh, first);
        first += int(mesh.points);
    }
}

std::vector<Vec3f> SceneMesh::vertices(size_t sample) const {
    std::vector<Vec3f> out;
    for (const size_t k : objects_) {
        const size_t own = file_->meshes()[k].times.size() > 1 ? sample : 0;
        const std::vector<Vec3f> points = file_->points_of_mesh(k, own);
        out.insert(out.end(), points.begin(), points.end());
    }
    return out;
}

Mesh first_mesh(const std::string& path, const std::string& object) {
    if (!is_scene_file(path)) return read_mesh(path, 1);
    const bool is_alone = open_scene_file(path)->meshes().size() == 1;
    const SceneMesh mesh(path, is_alone ? "" : object);
    return {mesh.vertices(0), mesh.triangles()};
}

FileAxes axes_of_mesh(const std::string& path) {
    if (is_scene_file(path)) return open_scene_file(path)->axes();
    return ending_of(path) == ".glb" ? FileAxes{1.0, 'y'} : FileAxes{};
}

}  // namespace wetcurl
