// Keyframes of meshes.
#include "solver/motion/deformation.h"

#include <algorithm>
#include <filesystem>

namespace wetcurl {

namespace {

std::string counts_of(size_t vertices, size_t triangles) {
    return std::to_string(vertices) + " vertices and " + std::to_string(triangles) + " triangles";
}

std::string corners_of(const std::array<int, 3>& t) {
    return std::to_string(t[0] + 1) + " " + std::to_string(t[1] + 1) + " " + std::to_string(t[2] + 1);
}

// Of one coordinate at the middle one of three keys.
float slope_at(double h0, float x0, float x1, double h1, float x2) {
    return float(monotone_slope(h0, (double(x1) - double(x0)) / h0, h1, (double(x2) - double(x1)) / h1));
}

}  // namespace

Mesh mesh_of(const Table& table, const std::string& file, double metres) {
    if (!std::filesystem::exists(file)) table.fail("file", "no file '" + file + "'");
    return read_mesh(file, metres);
}

Deformation::Deformation(const Table& solid, double metres) {
    const auto tables = solid.tables("mesh");
    if (tables.size() < 2)
        solid.fail(
            "mesh",
            "found one keyframe, needed two or more; file = \"...\" names a mesh that keeps its shape");
    std::string first;
    for (const Table& t : tables) {
        MeshKeyframeTable read;
        read_parameters(read, MeshKeyframeTable::parameters, t);
        const auto& [time, file] = read;
        if (file.empty()) t.fail("file", "a keyframe needs file = \"….obj\" or \"….ply\"");
        if (!keys_.empty() && !(time > keys_.back().time))
            t.fail("time", "found " + std::to_string(time) + " s, allowed above " +
                               std::to_string(keys_.back().time) + " s, the time of the keyframe before");
        Mesh mesh = mesh_of(t, file, metres);
        if (keys_.empty()) {
            first = file;
            triangles_ = mesh.triangles;
        } else if (mesh.vertices.size() != keys_[0].vertices.size() ||
                   mesh.triangles.size() != triangles_.size()) {
            t.fail("file", "'" + file + "' has " + counts_of(mesh.vertices.size(), mesh.triangles.size()) +
                               "; keyframes share the triangles of the first, and '" + first + "' has " +
                               counts_of(keys_[0].vertices.size(), triangles_.size()));
        } else if (mesh.triangles != triangles_) {
            const auto [mine, theirs] =
                std::mismatch(mesh.triangles.begin(), mesh.triangles.end(), triangles_.begin());
            t.fail("file", "triangle " + std::to_string(mine - mesh.triangles.begin() + 1) + " of '" + file +
                               "' joins vertices " + corners_of(*mine) +
                               "; keyframes share the triangles of the first, and that of '" + first +
                               "' joins " + corners_of(*theirs));
        }
        keys_.push_back({time, std::move(mesh.vertices), {}});
    }
    for (auto& key : keys_) key.slopes.assign(key.vertices.size(), Vec3f{0, 0, 0});
    for (size_t k = 1; k + 1 < keys_.size(); ++k) {
        const double h0 = keys_[k].time - keys_[k - 1].time, h1 = keys_[k + 1].time - keys_[k].time;
        for (size_t v = 0; v < keys_[k].vertices.size(); ++v) {
            const Vec3f &a = keys_[k - 1].vertices[v], &b = keys_[k].vertices[v],
                        &c = keys_[k + 1].vertices[v];
            keys_[k].slopes[v] = {slope_at(h0, a.x, b.x, h1, c.x), slope_at(h0, a.y, b.y, h1, c.y),
                                  slope_at(h0, a.z, b.z, h1, c.z)};
        }
    }
}

Mesh Deformation::at(double time) const {
    Mesh mesh{{}, triangles_};
    vertices_at(time, mesh.vertices);
    return mesh;
}

Deformation::Place Deformation::place_of(double time) const {
    const auto after =
        std::upper_bound(keys_.begin(), keys_.end(), time, [](double x, const Key& k) { return x < k.time; });
    const Key& from = after == keys_.begin() ? keys_.front() : after[-1];
    if (after == keys_.begin() || after == keys_.end()) return {from, nullptr, {}};
    const double h = after->time - from.time;
    return {from, &*after, hermite_weights((time - from.time) / h, h)};
}

Vec3d Deformation::Place::vertex(size_t v) const {
    if (!to) return cast<double>(from.vertices[v]);
    return w.from * cast<double>(from.vertices[v]) + w.from_slope * cast<double>(from.slopes[v]) +
           w.to * cast<double>(to->vertices[v]) + w.to_slope * cast<double>(to->slopes[v]);
}

void Deformation::vertices_at(double time, std::vector<Vec3f>& out) const {
    const Place place = place_of(time);
    out.resize(place.from.vertices.size());
    for (size_t v = 0; v < out.size(); ++v) out[v] = cast<float>(place.vertex(v));
}

void Deformation::vertices_at(double time, std::span<const int> which, std::vector<Vec3d>& out) const {
    const Place place = place_of(time);
    out.resize(which.size());
    for (size_t k = 0; k < which.size(); ++k) out[k] = place.vertex(size_t(which[k]));
}

Bounds Deformation::box() const {
    Bounds all = bounding_box({keys_[0].vertices, triangles_});
    for (const auto& key : keys_) {
        const Bounds box = bounding_box({key.vertices, triangles_});
        all = {lower(all.low, box.low), upper(all.high, box.high)};
    }
    return all;
}

}  // namespace wetcurl
