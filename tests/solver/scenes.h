// Small scenes on the built-in groom, and their runs: what the tests of whole simulations share.
#pragma once

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <sstream>
#include <string>
#include <vector>

#include "base/geometry/shapes.h"
#include "solver/run/simulation.h"
#include "solver/scene/scene.h"
#include "tests/base/scratch.h"

namespace wetcurl::testing {

// Stretch, bend and core on sixteen strands under gravity.
inline const std::string dry_scene = R"(fps = 24
[groom]
grid = [4, 4]
particles = 28
length = 0.15
[integrator]
substeps = 4
[stretch]
[bend]
[core]
)";

// The same hair as a fibre, of a scene that names these terms.
inline std::string as_fibre(std::string scene) {
    const std::string terms = "[stretch]\n[bend]\n[core]\n";
    return scene.replace(scene.find(terms), terms.size(), "[fibre]\n");
}

// All that a wet scene may name, a turning head, and a ball that lifts hair and lets it go.
inline const std::string wet_scene = dry_scene + R"([motion]
axis = [0, 1, 0]
angle = 20
period = 0.5
[wetness]
jitter = 0.3
[curl]
[cohesion]
radius = 0.03
spacing = 0
[adhesion]
[stiffness]
[[solid]]
name = "ball"
radius = 0.1
[[solid.motion.keyframe]]
time = 0.08
[[solid.motion.keyframe]]
time = 0.3
translation = [0, -0.02, 0.01]
)";

// The scene less a table and its keys; `title`: "[cohesion]".
inline std::string without(std::string scene, const std::string& title) {
    const size_t begin = scene.find(title + "\n"), end = scene.find("\n[", begin);
    scene.erase(begin, end == std::string::npos ? end : end + 1 - begin);
    return scene;
}

// Hair of which `crossing` makes straight lines from the roots through the head, past its middle, of such
// edges.
inline const std::string crossed_scene =
    dry_scene + "[wetness]\n[cohesion]\nradius = 0.004\n[[solid]]\nradius = 0.09\nattached = \"head\"\n";
inline constexpr float crossing_edge = 0.01f;  // [m]
inline Strands crossing(const Scene& scene) {
    Strands p = scene.groom.rest;
    for (int s = 0; s < p.count; ++s) {
        const Vec3f root = p.at(s, 0), way = Vec3f{0.03f, 0, 0} - root;
        for (int i = 0; i < p.particles; ++i)
            p.at(s, i) = root + (crossing_edge * float(i) / norm(way)) * way;
    }
    return p;
}

// The wet scene's strands, which touch, in a spray until `spray_ends` [s] and over a surface that rises from
// `rises` on for 0.2 s.
inline std::string flowing_scene(double rises, double spray_ends) {
    return wet_scene + R"([wetness.flow]
conductivity = 0.05
drying = 0.3
exchange = 8
reach = 0.01
[[wetness.source]]
shape = "plane"
center = [0, -0.1, 0]
rate = 20
[[wetness.source.motion.keyframe]]
time = )" + std::to_string(rises) +
           "\n[[wetness.source.motion.keyframe]]\ntime = " + std::to_string(rises + 0.2) + R"(
translation = [0, 0.06, 0]
[[wetness.source]]
shape = "sphere"
radius = 0.06
center = [0, 0.08, 0.1]
rate = 3
from = 0.04
until = )" +
           std::to_string(spray_ends) + "\n";
}

// The scenes that the project ships, by name, and where one of them is.
inline std::string shipped_scene(const std::string& name) {
    return WETCURL_SOURCE_DIR "/scenes/" + name + ".toml";
}
inline std::vector<std::string> shipped_scenes() {
    std::vector<std::string> out;
    for (const auto& file : std::filesystem::directory_iterator(WETCURL_SOURCE_DIR "/scenes")) {
        const std::string name = file.path().stem().string();
        if (file.path().extension() == ".toml" && !name.ends_with("recipe")) out.push_back(name);
    }
    std::sort(out.begin(), out.end());
    return out;
}

inline Scene scene_of(const std::string& text, const std::vector<std::string>& set = {}, int stride = 0) {
    SceneOptions options;
    options.set = set;
    options.stride = stride;
    return parse_scene(text, "scene.toml", ".", options);
}

inline std::string obj_of(const Mesh& mesh) {
    std::stringstream out;
    out.precision(9);
    for (const auto& v : mesh.vertices) out << "v " << v.x << ' ' << v.y << ' ' << v.z << '\n';
    for (const auto& t : mesh.triangles)
        out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
    return out.str();
}

// [[solid]] with a sphere of these radii [m], one every `interval` [s], around `center`.
inline std::string breathing_sphere(const Scratch& scratch, const std::vector<double>& radii, double interval,
                                    const std::string& center, double spacing, int around = 64) {
    std::stringstream out;
    out << "[[solid]]\nshape = \"mesh\"\nspacing = " << spacing
        << "\n[[solid.motion.keyframe]]\ntranslation = " << center << "\n";
    for (size_t k = 0; k < radii.size(); ++k) {
        const std::string name = "sphere" + std::to_string(k) + ".obj";
        scratch.file(name, obj_of(triangulated(Sphere{radii[k]}, around)));
        out << "[[solid.mesh]]\ntime = " << double(k) * interval << "\nfile = \"" << scratch.path(name)
            << "\"\n";
    }
    return out.str();
}

inline RunFrame after(const Scene& scene, int frames, const std::string& precision = "float") {
    const auto simulation = make_simulation(scene, precision);
    for (int f = 0; f < frames; ++f) simulation->advance();
    RunFrame frame;
    simulation->snapshot(frame);
    return frame;
}

// Of the sum of energies over so many frames in double precision: the largest rise above what it was before,
// how far it falls in all, and the kinetic energy at the end.
struct EnergyCourse {
    double rise = 0, fall = 0, kinetic = 0;
};
inline EnergyCourse energy_course(const Scene& scene, int frames) {
    const auto simulation = make_simulation(scene, "double");
    auto sum = [&] {
        const auto e = simulation->energy();
        return std::accumulate(e.begin(), e.end(), 0.0);
    };
    const double start = sum();
    double low = start;
    EnergyCourse course;
    for (int f = 0; f < frames; ++f) {
        simulation->advance();
        const double now = sum();
        course.rise = std::max(course.rise, now - low), low = std::min(low, now);
    }
    course.fall = start - low, course.kinetic = simulation->energy()[0];
    return course;
}

// The groom's particles thrown about the origin, every one near others of its strand and of the rest.
inline void scatter(Scene& scene, unsigned seed, double size) {
    Random random(seed);
    for (auto& x : scene.groom.rest.points) x = cast<float>(random.vector(size));
}
inline std::vector<Vec3d> positions_of(const Scene& scene) {
    std::vector<Vec3d> x;
    for (const auto& p : scene.groom.rest.points) x.push_back(cast<double>(p));
    return x;
}

// Between particles of strand s, and of all [m].
inline double farthest(const Strands& a, const Strands& b, int s) {
    double most = 0;
    for (int i = 0; i < a.particles; ++i) {
        const double d = norm(cast<double>(a.at(s, i)) - cast<double>(b.at(s, i)));
        most = d <= most ? most : d;  // NaN counts
    }
    return most;
}
inline double farthest(const Strands& a, const Strands& b) {
    double most = 0;
    for (int s = 0; s < a.count; ++s) {
        const double d = farthest(a, b, s);
        most = d <= most ? most : d;
    }
    return most;
}
// How many strands have a particle farther than `bound` [m] from its place in b.
inline int strands_astray(const Strands& a, const Strands& b, double bound) {
    int astray = 0;
    for (int s = 0; s < a.count; ++s) astray += !(farthest(a, b, s) < bound);
    return astray;
}
inline bool same_bits(const Vec3f& a, const Vec3f& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
inline bool same_bits(const Strands& a, const Strands& b) {
    if (a.points.size() != b.points.size()) return false;
    for (size_t k = 0; k < a.points.size(); ++k)
        if (!same_bits(a.points[k], b.points[k])) return false;
    return true;
}

}  // namespace wetcurl::testing
