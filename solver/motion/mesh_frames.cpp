// Frames from scene files and from numbered files.
#include "solver/motion/mesh_frames.h"

#include <algorithm>
#include <filesystem>
#include <map>

#include "base/exchange/scene_mesh.h"
#include "base/log.h"

namespace wetcurl {

namespace {

namespace fs = std::filesystem;

// body.0012.obj for the 12th of body.####.obj.
class NumberedFiles final : public MeshFrames {
  public:
    NumberedFiles(const std::string& pattern, double fps) {
        const fs::path whole(pattern);
        const std::string name = whole.filename().string();
        const size_t begin = name.find('#'), end = std::min(name.find_first_not_of('#', begin), name.size());
        const std::string before = name.substr(0, begin), after = name.substr(end);
        const size_t digits = end - begin;
        std::map<long, std::string> found;
        const fs::path folder = whole.parent_path().empty() ? "." : whole.parent_path();
        if (fs::is_directory(folder))
            for (const auto& entry : fs::directory_iterator(folder)) {
                const std::string file = entry.path().filename().string();
                if (file.size() < name.size() || !file.starts_with(before) || !file.ends_with(after))
                    continue;
                const std::string number =
                    file.substr(before.size(), file.size() - before.size() - after.size());
                // More digits than #: a shot that goes on beyond 9999.
                const bool whole_number = number.size() >= digits && number.size() < 10 &&
                                          (number.size() == digits || number[0] != '0') &&
                                          std::all_of(number.begin(), number.end(),
                                                      [](unsigned char c) { return std::isdigit(c); });
                if (whole_number) found[std::stol(number)] = entry.path().string();
            }
        if (found.empty())
            throw Misuse("no file '" + pattern +
                         "': # stands for the digits of a number, as body.####.obj for "
                         "body.0001.obj");
        std::string missing;
        long before_it = found.begin()->first;
        for (const auto& [number, file] : found) {
            if (number > before_it + 1)
                missing += (missing.empty() ? "" : ", ") + std::to_string(before_it + 1) +
                           (number > before_it + 2 ? " to " + std::to_string(number - 1) : "");
            before_it = number;
        }
        if (!missing.empty())
            log_warning(pattern + ": of its numbers " + missing +
                        " are missing; the mesh moves evenly from the one before to the one after");
        for (const auto& [number, file] : found) {
            times_.push_back(double(number) / fps);
            files_.push_back(file);
        }
        triangles_ = read_mesh(files_[0], 1).triangles;
    }
    std::vector<Vec3f> vertices(size_t frame) const override {
        Mesh mesh = read_mesh(files_[frame], 1);
        if (mesh.triangles != triangles_)
            throw Error(files_[frame] + ": " + std::to_string(mesh.triangles.size()) +
                        " triangles that are not those of " + files_[0] + ", which has " +
                        std::to_string(triangles_.size()) + "; all frames share the triangles of the first");
        if (count_ && mesh.vertices.size() != count_)
            throw Error(files_[frame] + ": " + std::to_string(mesh.vertices.size()) +
                        " vertices, allowed are " + std::to_string(count_) + " as in the frames before");
        count_ = mesh.vertices.size();
        return std::move(mesh.vertices);
    }
    std::string name_of(size_t frame) const override { return files_[frame]; }

  private:
    std::vector<std::string> files_;
    mutable size_t count_ = 0;
};

class SceneFileFrames final : public MeshFrames {
  public:
    SceneFileFrames(const std::string& path, const std::string& object) : path_(path), mesh_(path, object) {
        axes_ = mesh_.axes(), times_ = mesh_.times(), triangles_ = mesh_.triangles();
    }
    std::vector<Vec3f> vertices(size_t frame) const override { return mesh_.vertices(frame); }
    std::string name_of(size_t frame) const override {
        return path_ + " at " + std::to_string(times_[frame]) + " s";
    }

  private:
    const std::string path_;
    const SceneMesh mesh_;
};

}  // namespace

bool names_frames(const std::string& path) {
    return is_scene_file(path) || fs::path(path).filename().string().find('#') != std::string::npos;
}

std::unique_ptr<MeshFrames> open_mesh_frames(const std::string& path, const std::string& object, double fps) {
    if (!is_scene_file(path)) {
        if (!object.empty())
            throw Misuse("'" + path + "' has no object '" + object + "': numbered files hold one mesh each");
        return std::make_unique<NumberedFiles>(path, fps);
    }
    if (!fs::exists(path)) throw Misuse("no file '" + path + "'");
    return std::make_unique<SceneFileFrames>(path, object);
}

}  // namespace wetcurl
