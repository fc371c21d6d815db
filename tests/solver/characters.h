// Meshes that move as formulas say, and strands that stand on them: what tests of characters share.
#pragma once

#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "solver/grooms/import.h"
#include "tests/solver/scenes.h"

namespace wetcurl::testing {

using Warp = std::function<Vec3d(const Vec3d&, double)>;  // where a point of the rest shape is at a time [s]

// A capsule along y about the origin whose wall has vertices all along it.
struct Tube {
    double half_length = 0.3, radius = 0.1;  // [m]
    int around = 128, along = 120;

    // Of the half circle from one pole to the other, 0 to 1.
    Vec3d at(double turn, double share) const {
        const double quarter = std::numbers::pi / 2 * radius, way = share * (2 * quarter + 2 * half_length);
        double y = way - quarter - half_length, r = radius;
        if (way < quarter || way > quarter + 2 * half_length) {
            const double end = way < quarter ? -1 : 1,
                         angle = (way < quarter ? quarter - way : way - quarter - 2 * half_length) / radius;
            y = end * (half_length + radius * std::sin(angle)), r = radius * std::cos(angle);
        }
        return {r * std::cos(turn), y, r * std::sin(turn)};
    }
    Mesh mesh() const {
        Mesh out;
        const auto vertex = [&](int k, int row) { return row * around + k % around + 1; };
        out.vertices.push_back(cast<float>(at(0, 0)));
        for (int row = 0; row < along; ++row)
            for (int k = 0; k < around; ++k)
                out.vertices.push_back(
                    cast<float>(at(2 * std::numbers::pi * k / around, (row + 1.0) / (along + 1))));
        out.vertices.push_back(cast<float>(at(0, 1)));
        const int last = int(out.vertices.size()) - 1;
        for (int k = 0; k < around; ++k) {
            out.triangles.push_back({0, vertex(k, 0), vertex(k + 1, 0)});
            for (int row = 0; row + 1 < along; ++row) {
                out.triangles.push_back({vertex(k, row), vertex(k, row + 1), vertex(k + 1, row)});
                out.triangles.push_back({vertex(k + 1, row), vertex(k, row + 1), vertex(k + 1, row + 1)});
            }
            out.triangles.push_back({last, vertex(k + 1, along - 1), vertex(k, along - 1)});
        }
        return out;
    }
};

inline Mesh warped(Mesh mesh, const Warp& warp, double time) {
    for (auto& v : mesh.vertices) v = cast<float>(warp(cast<double>(v), time));
    return mesh;
}

// Keyframes of [[solid.mesh]], one each 1 / `rate` [s].
inline std::string mesh_keyframes(const Scratch& scratch, const Mesh& rest, const Warp& warp, double rate,
                                  int count) {
    std::string out;
    for (int k = 0; k < count; ++k) {
        const double time = k / rate;
        const std::string file =
            scratch.file("key" + std::to_string(k) + ".obj", obj_of(warped(rest, warp, time)));
        std::stringstream text;
        text.precision(17);
        text << "[[solid.mesh]]\ntime = " << time << "\nfile = \"" << file << "\"\n";
        out += text.str();
    }
    return out;
}

// [groom] of straight strands, written to a file.
struct StandingStrand {
    Vec3d root, direction;
};
inline std::string standing(const Scratch& scratch, const std::vector<StandingStrand>& strands, double length,
                            int particles, const std::string& scalp) {
    StrandPoints points;
    for (const auto& s : strands) {
        auto& line = points.emplace_back();
        for (int i = 0; i < particles; ++i)
            line.push_back(s.root + (length * i / (particles - 1)) * s.direction);
    }
    const std::string file = scratch.path("standing.data");
    write_strands(file, points, true);
    return "[groom]\nfile = \"" + file + "\"\nunits = \"m\"\nparticles = " + std::to_string(particles) +
           "\nscalp = \"" + scalp + "\"\n";
}

}  // namespace wetcurl::testing
