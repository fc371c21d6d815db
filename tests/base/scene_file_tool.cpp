// Writes and reads files of other programs for tests that compare with these programs.
//
//   scene_file_tool write FILE [unreal]   the shot of shot.h; for Unreal without its mesh
//   scene_file_tool print FILE            all that is read of a file, as JSON
//   scene_file_tool time FILE MB          writes strands of so many megabytes of points, and prints MB/s
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "shot.h"

using namespace wetcurl;

static nlohmann::json numbers_of(const std::vector<Vec3f>& points) {
    nlohmann::json out = nlohmann::json::array();
    for (const Vec3f& x : points) out.push_back({x.x, x.y, x.z});
    return out;
}

static void print(const std::string& path) {
    const auto file = open_scene_file(path);
    nlohmann::json out = {{"curves", nlohmann::json::array()}, {"meshes", nlohmann::json::array()}};
    if (file->axes().metres_per_unit) out["metres_per_unit"] = *file->axes().metres_per_unit;
    if (file->axes().up) out["up"] = std::string(1, *file->axes().up);
    constexpr const char* bases[] = {"linear", "bezier", "b_spline", "catmull_rom"};
    for (size_t k = 0; k < file->curves().size(); ++k) {
        const CurvesObject& o = file->curves()[k];
        nlohmann::json samples = nlohmann::json::array();
        for (size_t s = 0; s < o.times.size(); ++s)
            samples.push_back(numbers_of(file->points_of_curves(k, s)));
        out["curves"].push_back({{"path", o.path},
                                 {"counts", o.counts},
                                 {"basis", bases[int(o.basis)]},
                                 {"widths", o.widths},
                                 {"ids", o.ids},
                                 {"groups", o.groups},
                                 {"root_uv", o.root_uv},
                                 {"is_guide", o.is_guide},
                                 {"guides", o.guides},
                                 {"weights", o.weights},
                                 {"times", o.times},
                                 {"samples", samples}});
    }
    for (size_t k = 0; k < file->meshes().size(); ++k) {
        const MeshObject& o = file->meshes()[k];
        nlohmann::json samples = nlohmann::json::array();
        for (size_t s = 0; s < o.times.size(); ++s) samples.push_back(numbers_of(file->points_of_mesh(k, s)));
        out["meshes"].push_back({{"path", o.path},
                                 {"counts", o.counts},
                                 {"corners", o.corners},
                                 {"points", o.points},
                                 {"times", o.times},
                                 {"samples", samples}});
    }
    std::puts(out.dump().c_str());
}

static void time_writing(const std::string& path, double megabytes) {
    CurvesObject object;
    object.path = "/hair/strands";
    object.counts.assign(10000, 100);
    object.widths.assign(object.points(), 1e-4f);
    CurvesFrame frame;
    frame.points.resize(object.points());
    for (size_t i = 0; i < frame.points.size(); ++i) frame.points[i] = {float(i), float(i % 100), 0};
    const double each = double(frame.points.size() * sizeof(Vec3f)) / 1e6;
    const auto start = std::chrono::steady_clock::now();
    const auto file = create_scene_file(path, true, {});
    file->add_curves(object);
    double written = 0;
    for (; written < megabytes; written += each) {
        for (Vec3f& x : frame.points) x.z += 1;
        file->append_curves(0, frame);
    }
    file->finish();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("%.0f MB in %.2f s: %.0f MB/s\n", written, seconds, written / seconds);
}

int main(int count, char** arguments) {
    const std::vector<std::string> a(arguments + 1, arguments + count);
    try {
        if (a.size() >= 2 && a[0] == "write") {
            testing::Shot shot;
            shot.settings.for_unreal = a.size() > 2;
            shot.write(*create_scene_file(a[1], true, shot.settings), !shot.settings.for_unreal);
        } else if (a.size() == 2 && a[0] == "print") {
            print(a[1]);
        } else if (a.size() == 3 && a[0] == "time") {
            time_writing(a[1], std::stod(a[2]));
        } else {
            std::fputs("use: scene_file_tool write|print|time FILE ...\n", stderr);
            return 2;
        }
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
