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

Deformation::Deformation(const Table& solid, const FileFrame& frame) : frame_(frame) {
    const auto tables = solid.tables("mesh");
    if (tables.size() < 2)
        solid.fail(
            "mesh",
            "found one keyframe, needed two or more; file = \"...\" names a mesh that keeps its shape");
    std::string first;
    // Units are taken as numbers are read, in double precision.
    FileFrame in_metres = frame;
    in_metres.metres = 1;
    for (const Table& t : tables) {
        MeshKeyframeTable read;
        read_parameters(read, MeshKeyframeTable::parameters, t);
        const auto& [time, file] = read;
        if (file.empty()) t.fail("file", "a keyframe needs file = \"….obj\" or \"….ply\"");
        if (!times_.empty() && !(time > times_.back()))
            t.fail("time", "found " + std::to_string(time) + " s, allowed above " +
                               std::to_string(times_.back()) + " s, the time of the keyframe before");
        Mesh mesh = mesh_of(t, file, frame.metres);
        if (times_.empty()) {
            first = file;
            triangles_ = mesh.triangles;
        } else if (mesh.vertices.size() != near_[0]->size() || mesh.triangles.size() != triangles_.size()) {
            t.fail("file", "'" + file + "' has " + counts_of(mesh.vertices.size(), mesh.triangles.size()) +
                               "; keyframes share the triangles of the first, and '" + first + "' has " +
                               counts_of(near_[0]->size(), triangles_.size()));
        } else if (mesh.triangles != triangles_) {
            const auto [mine, theirs] =
                std::mismatch(mesh.triangles.begin(), mesh.triangles.end(), triangles_.begin());
            t.fail("file", "triangle " + std::to_string(mine - mesh.triangles.begin() + 1) + " of '" + file +
                               "' joins vertices " + corners_of(*mine) +
                               "; keyframes share the triangles of the first, and that of '" + first +
                               "' joins " + corners_of(*theirs));
        }
        in_metres.place(mesh.vertices);
        near_[times_.size()] = std::make_shared<const Vertices>(std::move(mesh.vertices));
        times_.push_back(time);
    }
    rest_at({});
}

Deformation::Deformation(std::unique_ptr<const MeshFrames> frames, const FileFrame& frame, double begin)
    : triangles_(frames->triangles()), times_(frames->times()), frames_(std::move(frames)), frame_(frame) {
    for (double& time : times_) time -= begin;
}

Deformation::Deformation(Mesh mesh) : triangles_(mesh.triangles), rest_(std::make_shared<const Mesh>(mesh)) {
    jump_to(0, std::move(mesh.vertices));
}

void Deformation::jump_to(double time, std::vector<Vec3f> vertices) {
    times_ = {time};
    Key key;
    key.slopes.assign(vertices.size(), Vec3f{0, 0, 0});
    key.vertices = near_[0] = std::make_shared<const Vertices>(std::move(vertices));
    keys_ = {{0, std::make_shared<const Key>(std::move(key))}};
}

// As DrivenMotion: a key's slope is that of the way to it.
void Deformation::go_to(double end, std::vector<Vec3f> vertices) {
    const std::shared_ptr<const Key> from = keys_.rbegin()->second;
    const float per_second = float(1 / (end - times_.back()));
    Key to;
    to.slopes.resize(vertices.size());
    for (size_t v = 0; v < vertices.size(); ++v)
        to.slopes[v] = per_second * (vertices[v] - (*from->vertices)[v]);
    to.vertices = std::make_shared<const Vertices>(std::move(vertices));
    times_ = {times_.back(), end};
    near_[0] = from->vertices;
    keys_ = {{0, from}, {1, std::make_shared<const Key>(std::move(to))}};
}

void Deformation::rest_as(Mesh mesh, const std::string& file) {
    frame_.place(mesh.vertices);
    if (mesh.triangles != triangles_ || mesh.vertices.size() != vertices_of(0)->size())
        throw Error(file + ": the mesh at rest has " +
                    counts_of(mesh.vertices.size(), mesh.triangles.size()) +
                    ", allowed are the triangles of the frames, which have " +
                    counts_of(vertices_of(0)->size(), triangles_.size()));
    rest_ = std::make_shared<const Mesh>(std::move(mesh));
}

void Deformation::wind(Winding& found) {
    triangles_ = consistently_wound({*vertices_of(0), triangles_}, &found).triangles;
    if (!rest_) return;
    Mesh rest = *rest_;
    rest.triangles = triangles_;
    rest_ = std::make_shared<const Mesh>(std::move(rest));
}

void Deformation::rest_at(const ShotCuts& cuts) {
    cuts_ = cuts;
    keys_.clear();
    if (frames_) return;
    for (size_t k = 0; k < times_.size(); ++k) keys_[k] = key_of_neighbours(k);
}

std::shared_ptr<const Deformation::Vertices> Deformation::vertices_of(size_t k) const {
    if (const auto found = near_.find(k); found != near_.end()) return found->second;
    Vertices vertices = frames_->vertices(k);
    if (const Bounds box = bounding_box({vertices, {}}); !(norm(box.high - box.low) > 0))
        throw Error(
            frames_->name_of(k) + ": all " + std::to_string(vertices.size()) +
            " vertices stand in one place, allowed is a mesh with an extent: export this frame again");
    frame_.place(vertices);
    return near_[k] = std::make_shared<const Vertices>(std::move(vertices));
}

std::shared_ptr<const Deformation::Key> Deformation::key_of_neighbours(size_t k) const {
    auto out = std::make_shared<Key>();
    out->vertices = vertices_of(k);
    const size_t count = out->vertices->size();
    out->slopes.assign(count, Vec3f{0, 0, 0});
    // At rest at both ends, and on both sides of a cut.
    if (k == 0 || k + 1 == times_.size() || cuts_.between(times_[k - 1], times_[k]) ||
        cuts_.between(times_[k], times_[k + 1]))
        return out;
    const double h0 = times_[k] - times_[k - 1], h1 = times_[k + 1] - times_[k];
    const Vertices &before = *vertices_of(k - 1), &after = *vertices_of(k + 1);
    for (size_t v = 0; v < count; ++v) {
        const Vec3f &a = before[v], &b = (*out->vertices)[v], &c = after[v];
        out->slopes[v] = {slope_at(h0, a.x, b.x, h1, c.x), slope_at(h0, a.y, b.y, h1, c.y),
                          slope_at(h0, a.z, b.z, h1, c.z)};
    }
    return out;
}

std::shared_ptr<const Deformation::Key> Deformation::key(size_t k) const {
    const std::lock_guard alone(mutex_);
    if (const auto found = keys_.find(k); found != keys_.end()) return found->second;
    const auto made = keys_[k] = key_of_neighbours(k);
    // A cubic needs two keys and the frames on either side of them; one more, for who asks back and forth.
    std::erase_if(keys_, [&](const auto& one) { return one.first + 2 < k || one.first > k + 2; });
    std::erase_if(near_, [&](const auto& one) { return one.first + 2 < k || one.first > k + 2; });
    return made;
}

Mesh Deformation::at(double time) const {
    Mesh mesh{{}, triangles_};
    vertices_at(time, mesh.vertices);
    return mesh;
}

Deformation::Place Deformation::place_of(double time) const {
    const size_t after = size_t(std::upper_bound(times_.begin(), times_.end(), time) - times_.begin());
    if (after == 0 || after == times_.size()) return {key(after == 0 ? 0 : after - 1), nullptr, {}};
    const double h = times_[after] - times_[after - 1];
    return {key(after - 1), key(after), hermite_weights((time - times_[after - 1]) / h, h)};
}

Vec3d Deformation::Place::vertex(size_t v) const {
    const Vec3d a = cast<double>((*from->vertices)[v]);
    if (!to) return a;
    return w.from * a + w.from_slope * cast<double>(from->slopes[v]) +
           w.to * cast<double>((*to->vertices)[v]) + w.to_slope * cast<double>(to->slopes[v]);
}

void Deformation::vertices_at(double time, std::vector<Vec3f>& out) const {
    const Place place = place_of(time);
    out.resize(place.from->vertices->size());
    for (size_t v = 0; v < out.size(); ++v) out[v] = cast<float>(place.vertex(v));
}

void Deformation::vertices_at(double time, std::span<const int> which, std::vector<Vec3d>& out) const {
    const Place place = place_of(time);
    out.resize(which.size());
    for (size_t k = 0; k < which.size(); ++k) out[k] = place.vertex(size_t(which[k]));
}

Bounds Deformation::box(double from, double to) const {
    constexpr double inf = std::numeric_limits<double>::infinity();
    Bounds all{{inf, inf, inf}, {-inf, -inf, -inf}};
    // And a key on either side.
    const long first = std::upper_bound(times_.begin(), times_.end(), from) - times_.begin(),
               end = std::lower_bound(times_.begin(), times_.end(), to) - times_.begin();
    for (long k = std::max(0L, first - 1); k < std::min(long(times_.size()), end + 1); ++k) {
        const auto vertices = key(size_t(k))->vertices;
        const Bounds box = bounding_box({*vertices, triangles_});
        all = {lower(all.low, box.low), upper(all.high, box.high)};
    }
    return all;
}

}  // namespace wetcurl
