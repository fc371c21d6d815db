// Hair for the tests of learn: curls on a spherical cap, whole runs of it, rigid motions.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "base/run_cache.h"
#include "tests/base/scratch.h"

namespace wetcurl::testing {

struct Curls {
    int width = 8, height = 8, particles = 50;
    double length = 0.2, radius = 0.008, turns = 5;  // of the axis; [m]
    double phase_spread = 2 * std::numbers::pi;      // of the curls' phases [rad]
    double spacing = 0.006;                          // of roots [m]
    double lean = 0.3;                               // how far axes bend outward, over their length
};

// Helices that hang from roots on a cap (radius 0.1 m); phases at random from root to root.
inline Groom curly_groom(const Curls& c, unsigned seed = 1) {
    Groom g;
    g.grid = {c.width, c.height, {}};
    g.rest = Strands(c.width * c.height, c.particles);
    Random random(seed);
    for (int s = 0; s < g.rest.count; ++s) {
        g.grid.strand.push_back(s);
        const double x = c.spacing * (s % c.width - 0.5 * c.width),
                     z = c.spacing * (s / c.width - 0.5 * c.height);
        const Vec3d root{x, std::sqrt(0.01 - x * x - z * z), z};
        const double start = random.number(0, 1) * c.phase_spread;
        for (int i = 0; i < c.particles; ++i) {
            const double t = double(i) / (c.particles - 1), a = start + 2 * std::numbers::pi * c.turns * t;
            // All lean outward alike, so that neighbouring axes are nearly parallel.
            const Vec3d axis{c.lean * c.length * t * t, -c.length * t, 0};
            const Vec3d curl{c.radius * (std::cos(a) - std::cos(start)), 0,
                             c.radius * (std::sin(a) - std::sin(start))};
            g.rest.at(s, i) = cast<float>(root + axis + curl);
        }
        g.normal.push_back(cast<float>(10.0 * root));
    }
    return g;
}

inline Pose some_pose(unsigned seed) {
    Random random(seed);
    return {random.rotation(), random.vector(0.3)};
}

inline Strands moved(const Strands& strands, const Pose& pose) {
    Strands out = strands;
    for (Vec3f& p : out.points) p = cast<float>(pose(cast<double>(p)));
    return out;
}

inline double largest_distance(const Strands& a, const Strands& b) {
    double most = a.points.size() == b.points.size() ? 0 : 1e9;
    for (size_t k = 0; k < std::min(a.points.size(), b.points.size()); ++k)
        most = std::max(most, double(norm(a.points[k] - b.points[k])));
    return most;
}

// A head that turns and drifts.
inline Pose head_at(int frame) {
    return {rotation_about({0, 1, 0}, 0.05 * frame), {0.002 * frame * frame, 0.1, -0.001 * frame}};
}

// Writes a run of `frames` frames; `bend(strand, particle, frame)` is added to the rest shape (head's frame);
// what is seen lies `shown` from that, at zero the run has nothing else.
inline void write_run(
    const std::string& path, const Groom& groom, int stride, int frames, const std::vector<float>& saturation,
    const std::function<Vec3d(int, int, int)>& bend =
        [](int, int, int) {
            return Vec3d{0, 0, 0};
        },
    const std::function<Pose(int)>& head = head_at, const Vec3f& shown = {0, 0, 0}) {
    RunHeader header;
    header.method = saturation.empty() ? "simulated dry" : "simulated wet";
    header.groom = groom;
    header.scene_folder = ".";
    header.stride = stride;
    header.saturation = saturation;
    RunWriter writer(path, header, true);
    for (int f = 0; f < frames; ++f) {
        RunFrame frame;
        frame.head = head(f);
        frame.positions = groom.rest;
        for (int s = 0; s < groom.rest.count; ++s)
            for (int i = 0; i < groom.rest.particles; ++i) {
                Vec3f& p = frame.positions.at(s, i);
                p = cast<float>(frame.head(cast<double>(p) + bend(s, i, f)));
            }
        if (norm(shown) > 0) {
            frame.displayed = frame.positions;
            for (Vec3f& p : frame.displayed.points) p += shown;
        }
        frame.seconds = 0.5;
        writer.append(frame);
    }
    writer.commit();
}

}  // namespace wetcurl::testing
