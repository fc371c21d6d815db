// Writes and reads files of other programs for tests that compare with these programs.
//
//   scene_file_tool write FILE [unreal]   the shot of shot.h; for Unreal without its mesh
//   scene_file_tool strands FILE UP M     three strands, a mesh that moves and one that does not, M metres a
//   unit scene_file_tool print FILE            all that is read of a file, as JSON scene_file_tool time FILE
//   MB          writes strands of so many megabytes of points, and prints MB/s
#include <chrono>
#include <cmath>
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
                                 {"hidden", o.hidden},
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
                                 {"hidden", o.hidden},
                                 {"counts", o.counts},
                                 {"corners", o.corners},
                                 {"points", o.points},
                                 {"times", o.times},
                                 {"samples", samples}});
    }
    std::puts(out.dump().c_str());
}

// As usda_with_others.py computes them.
static Vec3f strand_point(int strand, int point, int frame) {
    return {float(0.01 * strand + 0.001 * frame), float(0.2 - 0.01 * point),
            float(0.003 * std::sin(point + 0.1 * frame))};
}

static void write_strands(const std::string& path, char up, double metres_per_unit) {
    constexpr int frames = 4;
    CurvesObject curves;
    curves.path = "/hair/strands";
    curves.counts = {5, 3, 8};
    for (size_t s = 0; s < curves.counts.size(); ++s) {
        for (int i = 0; i < curves.counts[s]; ++i) curves.widths.push_back(float(1e-4 - 1e-5 * i));
        curves.ids.push_back(int(100 + s));
        curves.root_uv.push_back({0.25f * float(s), 0.5f});
    }
    const MeshObject still{"/head/scalp", {}, {4, 3}, {0, 1, 2, 3, 0, 1, 4}, 5, {}};
    MeshObject moving = still;
    moving.path = "/head/jaw";
    const auto out = create_scene_file(
        path, true, {.fps = 25, .first_frame = 1001, .metres_per_unit = metres_per_unit, .up = up});
    out->add_curves(curves);
    out->add_mesh(still);
    out->add_mesh(moving);
    for (int frame = 0; frame < frames; ++frame) {
        CurvesFrame hair;
        for (size_t s = 0; s < curves.counts.size(); ++s)
            for (int i = 0; i < curves.counts[s]; ++i) {
                hair.points.push_back(strand_point(int(s), i, frame));
                hair.velocities.push_back({0.025f, 0, float(frame)});
                hair.wetness.push_back(0.125f * float(frame));
            }
        out->append_curves(0, hair);
        std::vector<Vec3f> corners;
        for (int k = 0; k < 5; ++k) corners.push_back({float(k), float(k * k), 0.5f});
        out->append_mesh(1, corners);
        for (auto& x : corners) x.z += float(frame);
        out->append_mesh(2, corners);
    }
    out->finish();
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
        } else if (a.size() == 4 && a[0] == "strands") {
            write_strands(a[1], a[2].at(0), std::stod(a[3]));
        } else if (a.size() == 2 && a[0] == "print") {
            print(a[1]);
        } else if (a.size() == 3 && a[0] == "time") {
            time_writing(a[1], std::stod(a[2]));
        } else {
            std::fputs("use: scene_file_tool write|strands|print|time FILE ...\n", stderr);
            return 2;
        }
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
