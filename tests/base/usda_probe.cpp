// Writes a known scene, or prints what a file holds, for the test that compares with Pixar's own library.
//
//   usda_probe write FILE UP METRES_PER_UNIT
//   usda_probe print FILE                      as JSON
//   usda_probe speed FILE STRANDS POINTS FRAMES  writes FILE, reads it, and prints MB/s
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "base/error.h"
#include "base/exchange/scene_file.h"

namespace wetcurl {
namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

// As check_usda.py computes them.
Vec3f strand_point(int strand, int point, int frame) {
    return {float(0.01 * strand + 0.001 * frame), float(0.2 - 0.01 * point),
            float(0.003 * std::sin(point + 0.1 * frame))};
}

void write(const std::string& path, char up, double metres_per_unit) {
    constexpr int frames = 4;
    CurvesObject curves;
    curves.path = "/hair/strands";
    curves.counts = {5, 3, 8};
    for (size_t s = 0; s < curves.counts.size(); ++s) {
        for (int i = 0; i < curves.counts[s]; ++i) curves.widths.push_back(float(1e-4 - 1e-5 * i));
        curves.ids.push_back(int(100 + s));
        curves.root_uv.push_back({0.25f * float(s), 0.5f});
    }
    const MeshObject still{"/head/scalp", {4, 3}, {0, 1, 2, 3, 0, 1, 4}, 5, {}};
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

void print(const std::string& path) {
    const auto in = open_scene_file(path);
    auto samples = [](size_t count, auto points_at) {
        Json all = Json::array();
        for (size_t k = 0; k < count; ++k) {
            Json points = Json::array();
            for (const auto& x : points_at(k)) points.push_back({x.x, x.y, x.z});
            all.push_back(points);
        }
        return all;
    };
    Json json{{"curves", Json::array()}, {"meshes", Json::array()}};
    if (in->axes().up) json["up"] = std::string(1, *in->axes().up);
    if (in->axes().metres_per_unit) json["metres_per_unit"] = *in->axes().metres_per_unit;
    for (size_t o = 0; o < in->curves().size(); ++o) {
        const CurvesObject& c = in->curves()[o];
        json["curves"].push_back(
            {{"path", c.path},
             {"counts", c.counts},
             {"basis", int(c.basis)},
             {"widths", c.widths},
             {"ids", c.ids},
             {"root_uv", c.root_uv},
             {"times", c.times},
             {"points", samples(c.times.size(), [&](size_t k) { return in->points_of_curves(o, k); })}});
    }
    for (size_t o = 0; o < in->meshes().size(); ++o) {
        const MeshObject& m = in->meshes()[o];
        json["meshes"].push_back(
            {{"path", m.path},
             {"counts", m.counts},
             {"corners", m.corners},
             {"times", m.times},
             {"points", samples(m.times.size(), [&](size_t k) { return in->points_of_mesh(o, k); })}});
    }
    std::cout << json.dump() << "\n";
}

void speed(const std::string& path, int strands, int points, int frames) {
    auto start = Clock::now();
    {
        CurvesObject curves;
        curves.path = "/hair/strands";
        curves.counts.assign(size_t(strands), points);
        const auto out = create_scene_file(path, true, {});
        out->add_curves(curves);
        std::vector<Vec3f> all;
        for (int frame = 0; frame < frames; ++frame) {
            all.clear();
            for (int s = 0; s < strands; ++s)
                for (int i = 0; i < points; ++i) {
                    const Vec3f x = strand_point(s, i, frame);
                    all.push_back({x.x * 1.37f, x.y * 0.913f, x.z});
                }
            out->append_curves(0, {all, all, {}});
        }
        std::printf("append %.2f s, ", seconds_since(start));
        out->finish();
    }
    const double megabytes = double(std::filesystem::file_size(path)) / 1e6;
    std::printf("write %.1f MB in %.2f s: %.0f MB/s\n", megabytes, seconds_since(start),
                megabytes / seconds_since(start));
    start = Clock::now();
    const auto in = open_scene_file(path);
    std::printf("open %.2f s: %.0f MB/s\n", seconds_since(start), megabytes / seconds_since(start));
    start = Clock::now();
    for (int frame = 0; frame < frames; ++frame) in->points_of_curves(0, size_t(frame));
    // Points are half of the file; velocities are passed over.
    std::printf("points %.2f s: %.0f MB/s\n", seconds_since(start), megabytes / 2 / seconds_since(start));
}

}  // namespace
}  // namespace wetcurl

int main(int count, char** words) {
    const std::vector<std::string> w(words + 1, words + count);
    try {
        if (w.size() == 4 && w[0] == "write")
            wetcurl::write(w[1], w[2].at(0), std::stod(w[3]));
        else if (w.size() == 2 && w[0] == "print")
            wetcurl::print(w[1]);
        else if (w.size() == 5 && w[0] == "speed")
            wetcurl::speed(w[1], std::stoi(w[2]), std::stoi(w[3]), std::stoi(w[4]));
        else
            return 2;
    } catch (const wetcurl::Error& e) {
        std::cerr << e.what() << "\n";
        return 1;
    }
    return 0;
}
