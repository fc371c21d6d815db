// Meshes of .glb files: the triangles of all nodes of the scene, placed by the nodes. Khronos, glTF 2.0
// Specification, sections 3.5 (nodes), 3.6 (accessors), 3.7.2 (meshes), 4.4 (layout of .glb). Skins, morph
// targets and animations are not read.
#include "base/geometry/mesh_glb.h"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string_view>

namespace wetcurl {

namespace {

using nlohmann::json;

// Rows of x -> A x + b.
struct Affine {
    Vec3d row[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    Vec3d shift{0, 0, 0};
    Vec3d operator()(const Vec3d& x) const {
        return Vec3d{dot(row[0], x), dot(row[1], x), dot(row[2], x)} + shift;
    }
    Affine after(const Affine& inner) const {
        Affine out;
        const Vec3d o = inner({0, 0, 0}), x = inner({1, 0, 0}) - o, y = inner({0, 1, 0}) - o,
                    z = inner({0, 0, 1}) - o;
        for (int k = 0; k < 3; ++k) out.row[k] = {dot(row[k], x), dot(row[k], y), dot(row[k], z)};
        out.shift = (*this)(o);
        return out;
    }
};

class Glb {
  public:
    Glb(const std::string& bytes, const std::string& path) : path_(path), bytes_(bytes) {
        constexpr uint32_t glTF = 0x46546C67, as_json = 0x4E4F534A, as_binary = 0x004E4942;
        if (bytes.size() < 20 || word(0) != glTF) fail("no .glb file: it does not begin with 'glTF'");
        if (word(4) != 2) fail("glTF version " + std::to_string(word(4)) + ", allowed is 2");
        for (size_t at = 12; at + 8 <= bytes.size();) {
            const size_t size = word(at), kind = word(at + 4);
            if (size > bytes.size() - at - 8) fail("the file is cut short");
            const std::string_view chunk(bytes.data() + at + 8, size);
            if (kind == as_json && root_.is_null()) {
                root_ = json::parse(chunk, nullptr, false);
                if (!root_.is_object()) fail("its JSON cannot be read");
            }
            if (kind == as_binary && binary_.empty()) binary_ = chunk;
            at += 8 + size;
        }
        if (root_.is_null()) fail("it has no JSON");
        if (root_.contains("extensionsRequired"))
            for (const json& name : root_["extensionsRequired"])
                if (const std::string text = name.get<std::string>();
                    text.find("compression") != std::string::npos ||
                    text.find("quantization") != std::string::npos)
                    fail("needs " + text + ", which is not read: export it without compression");
    }

    Mesh mesh() {
        std::vector<char> is_child(count("nodes"), 0);
        for (size_t n = 0; n < is_child.size(); ++n)
            for (const json& child : list(at("nodes", n), "children")) is_child.at(child.get<size_t>()) = 1;
        if (count("scenes") > 0) {
            for (const json& node : list(at("scenes", root_.value("scene", size_t(0))), "nodes"))
                add_node(node.get<size_t>(), {});
        } else {
            for (size_t n = 0; n < is_child.size(); ++n)
                if (!is_child[n]) add_node(n, {});
        }
        if (mesh_.triangles.empty()) fail("no triangles found: expected a mesh with a surface");
        return std::move(mesh_);
    }

  private:
    [[noreturn]] void fail(const std::string& text) const { throw Error(path_ + ": " + text); }
    uint32_t word(size_t at) const {
        uint32_t out;
        std::memcpy(&out, bytes_.data() + at, sizeof out);
        return out;
    }
    size_t count(const char* what) const { return root_.contains(what) ? root_[what].size() : 0; }
    const json& at(const char* what, size_t number) const {
        if (number >= count(what))
            fail("number " + std::to_string(number) + " of " + what + ", of which it has " +
                 std::to_string(count(what)));
        return root_[what][number];
    }
    static json list(const json& of, const char* key) { return of.value(key, json::array()); }

    Affine placed_by(const json& node) const {
        Affine out;
        if (const json m = list(node, "matrix"); m.size() == 16) {  // by columns
            const auto number = [&](size_t row, size_t column) { return m[4 * column + row].get<double>(); };
            for (size_t k = 0; k < 3; ++k) out.row[k] = {number(k, 0), number(k, 1), number(k, 2)};
            out.shift = {number(0, 3), number(1, 3), number(2, 3)};
            return out;
        }
        const auto three = [&](const char* key, double usual) {
            const json v = list(node, key);
            return v.size() == 3 ? Vec3d{v[0].get<double>(), v[1].get<double>(), v[2].get<double>()}
                                 : Vec3d{usual, usual, usual};
        };
        const Vec3d scale = three("scale", 1);
        Quatd turn = Quatd::identity();
        if (const json q = list(node, "rotation"); q.size() == 4)
            turn = normalized(
                Quatd{q[3].get<double>(), q[0].get<double>(), q[1].get<double>(), q[2].get<double>()});
        const Vec3d x = rotate(turn, {scale.x, 0, 0}), y = rotate(turn, {0, scale.y, 0}),
                    z = rotate(turn, {0, 0, scale.z});
        out.row[0] = {x.x, y.x, z.x}, out.row[1] = {x.y, y.y, z.y}, out.row[2] = {x.z, y.z, z.z};
        out.shift = three("translation", 0);
        return out;
    }

    void add_node(size_t number, const Affine& above) {
        if (++nodes_seen_ > count("nodes")) fail("its nodes are no tree");
        const json& node = at("nodes", number);
        const Affine here = above.after(placed_by(node));
        if (node.contains("mesh"))
            for (const json& primitive : list(at("meshes", node["mesh"].get<size_t>()), "primitives"))
                add_triangles(primitive, here);
        for (const json& child : list(node, "children")) add_node(child.get<size_t>(), here);
    }

    void add_triangles(const json& primitive, const Affine& here) {
        constexpr int triangles = 4, strip = 5;
        const int mode = primitive.value("mode", triangles);
        if (mode < triangles) return;  // points and lines
        if (mode >= strip) fail("triangle strips and fans are not read: export it as triangles");
        const json& attributes = primitive.at("attributes");
        if (!attributes.contains("POSITION")) return;
        const size_t first = mesh_.vertices.size();
        const Elements points = elements(attributes["POSITION"].get<size_t>());
        if (points.kind != 5126 || points.size != 12) fail("positions that are not three floats");
        for (size_t k = 0; k < points.count; ++k) {
            float x[3];
            std::memcpy(x, points.at(k), sizeof x);
            const Vec3d placed = here({x[0], x[1], x[2]});
            constexpr double farthest = 1e6;  // [m]; beyond, single precision has no millimetres to spare
            for (const double c : {placed.x, placed.y, placed.z})
                if (!(std::abs(c) <= farthest))
                    fail("vertex " + std::to_string(k) + ": coordinate " + std::to_string(c) +
                         " m, allowed up to " + std::to_string(int(farthest)) + " m from the origin");
            mesh_.vertices.push_back(cast<float>(placed));
        }
        std::vector<size_t> corners;
        if (primitive.contains("indices")) {
            const Elements indices = elements(primitive["indices"].get<size_t>());
            if (indices.size > 4) fail("indices that are not single numbers");
            for (size_t k = 0; k < indices.count; ++k) {
                uint32_t index = 0;
                std::memcpy(&index, indices.at(k), indices.size);
                corners.push_back(index);
            }
        } else {
            for (size_t k = 0; k < points.count; ++k) corners.push_back(k);
        }
        for (size_t k = 0; k + 2 < corners.size(); k += 3) {
            std::array<int, 3> t;
            for (size_t c = 0; c < 3; ++c) {
                if (corners[k + c] >= points.count)
                    fail("vertex index out of range: found " + std::to_string(corners[k + c]) + " of " +
                         std::to_string(points.count) + " vertices");
                t[c] = int(first + corners[k + c]);
            }
            if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh_.triangles.push_back(t);
        }
    }

    // Of an accessor.
    struct Elements {
        const char* first;
        size_t count, size, stride;  // size, stride [bytes]
        int kind;
        const char* at(size_t k) const { return first + k * stride; }
    };
    Elements elements(size_t accessor) const {
        const json& a = at("accessors", accessor);
        if (a.contains("sparse") || !a.contains("bufferView")) fail("sparse accessors are not read");
        const json& view = at("bufferViews", a["bufferView"].get<size_t>());
        if (view.value("buffer", size_t(0)) != 0 || at("buffers", 0).contains("uri"))
            fail("its numbers stand in another file: export it as one .glb");
        Elements out;
        out.kind = a.value("componentType", 0);
        out.count = a.value("count", size_t(0));
        const size_t bytes = out.kind == 5121 ? 1 : out.kind == 5123 ? 2 : 4;
        if (out.kind != 5121 && out.kind != 5123 && out.kind != 5125 && out.kind != 5126)
            fail("component type " + std::to_string(out.kind) + " of an accessor");
        const std::string type = a.value("type", "");
        if (type != "SCALAR" && type != "VEC3") fail("an accessor of type " + type);
        out.size = bytes * (type == "VEC3" ? 3 : 1);
        out.stride = view.value("byteStride", out.size);
        const size_t begin = view.value("byteOffset", size_t(0)) + a.value("byteOffset", size_t(0));
        if (begin > binary_.size() ||
            (out.count > 0 && (out.stride > binary_.size() || out.count > binary_.size() ||
                               (out.count - 1) * out.stride + out.size > binary_.size() - begin)))
            fail("an accessor reaches beyond the file's end");
        out.first = binary_.data() + begin;
        return out;
    }

    const std::string& path_;
    const std::string& bytes_;
    json root_;
    std::string_view binary_;
    size_t nodes_seen_ = 0;
    Mesh mesh_;
};

}  // namespace

Mesh mesh_of_glb(const std::string& bytes, const std::string& path) {
    try {
        return Glb(bytes, path).mesh();
    } catch (const nlohmann::json::exception& e) {
        throw Error(path + ": not as glTF 2.0 has it: " + e.what());
    } catch (const std::out_of_range&) {
        throw Error(path + ": a node has a child that is not there");
    }
}

}  // namespace wetcurl
