// Reading .obj and .ply meshes, every number judged. Ours, after the formats' descriptions (Wavefront,
// Stanford).
#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <unordered_map>

#include "base/file_ending.h"
#include "base/geometry/mesh_glb.h"
#include "base/geometry/polygon_fan.h"
#include "base/lfs_pointer.h"

namespace wetcurl {

static_assert(std::endian::native == std::endian::little, "binary .ply is read in place");

namespace {

[[noreturn]] void fail(const std::string& where, const std::string& message) {
    throw Error(where + ": " + message);
}

std::string whole_file(const std::string& path) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) fail(path, "no such file");
    std::ifstream in(path, std::ios::binary);
    if (!in || !std::filesystem::is_regular_file(path, ignored)) fail(path, "cannot be read as a file");
    std::string text{std::istreambuf_iterator<char>(in), {}};
    if (text.empty()) fail(path, "the file is empty, expected a mesh");
    // Some programs mark UTF-8 so.
    if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
    refuse_lfs_pointer(text, path);
    return text;
}

// What was found, fit for a message: short, and printable whatever the file holds.
std::string shown(std::string_view found) {
    std::string text(found.substr(0, 24));
    for (char& c : text)
        if (c < 32 || c > 126) c = '?';
    return "'" + text + (found.size() > 24 ? "…'" : "'");
}

// Words of one line.
class Words {
  public:
    explicit Words(std::string_view line) : rest_(line) {}
    std::string_view next() {
        const size_t from = std::min(rest_.find_first_not_of(blanks), rest_.size());
        const size_t to = std::min(rest_.find_first_of(blanks, from), rest_.size());
        const std::string_view word = rest_.substr(from, to - from);
        rest_.remove_prefix(to);
        return word;
    }

  private:
    static constexpr const char* blanks = " \t\r\v\f";
    std::string_view rest_;
};

// A text taken line by line, with its place for messages.
class Lines {
  public:
    Lines(std::string_view text, const std::string& path) : rest_(text), path_(path) {}
    bool next(std::string_view& line) {
        if (rest_.empty()) return false;
        const size_t end = rest_.find('\n');
        line = rest_.substr(0, end);
        rest_.remove_prefix(end == std::string_view::npos ? rest_.size() : end + 1);
        ++number_;
        return true;
    }
    std::string where() const { return path_ + ":" + std::to_string(number_); }
    std::string_view rest() const { return rest_; }

  private:
    std::string_view rest_;
    std::string path_;
    int number_ = 0;
};

template <class T>
T number_in(std::string_view word, const std::string& where, const char* what) {
    if (word.empty()) fail(where, std::string("the file is cut short: expected ") + what);
    if (word.front() == '+') word.remove_prefix(1);
    T value{};
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    // from_chars does not tell too large from too small; the coordinate's own limit judges the former.
    if (std::is_floating_point_v<T> && error == std::errc::result_out_of_range)
        return T(std::strtod(std::string(word).c_str(), nullptr));
    if (error != std::errc{} || end != word.data() + word.size())
        fail(where, std::string("expected ") + what + ", found " + shown(word));
    return value;
}

// Gathers a mesh from the readers, which call it in file order, and judges every number.
class MeshBuilder {
  public:
    explicit MeshBuilder(double scale) : scale_(scale) {}

    void vertex(const Vec3d& p, const std::string& where) {
        const Vec3d metres = scale_ * p;
        for (double c : {metres.x, metres.y, metres.z})
            if (!(std::abs(c) <= farthest))
                fail(where, "coordinate " + std::to_string(c) + " m, allowed up to " +
                                std::to_string(int(farthest)) + " m from the origin");
        mesh_.vertices.push_back(cast<float>(metres));
    }
    // `corners` counted from 0.
    void polygon(const std::vector<long long>& corners, const std::string& where) {
        if (corners.size() < 3)
            fail(where, "a face of " + std::to_string(corners.size()) + " corners, allowed 3 or more");
        for (long long c : corners)
            if (c < 0 || c >= (long long)mesh_.vertices.size())
                fail(where, "vertex index out of range: found number " + std::to_string(c + 1) + " of " +
                                std::to_string(mesh_.vertices.size()) + " vertices");
        keys_.clear();
        for (long long c : corners) keys_.push_back(key_of(mesh_.vertices[size_t(c)]));
        const size_t start = fans_.start_of(keys_), n = corners.size();
        for (size_t k = 1; k + 1 < n; ++k) {
            const std::array<int, 3> t{int(corners[start]), int(corners[(start + k) % n]),
                                       int(corners[(start + k + 1) % n])};
            // A repeated corner spans no surface.
            if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) mesh_.triangles.push_back(t);
        }
    }
    long long vertices() const { return (long long)mesh_.vertices.size(); }
    Mesh finish(const std::string& path) {
        if (mesh_.vertices.empty())
            fail(path, "no vertices found: not a mesh of the format that its name says");
        if (mesh_.triangles.empty())
            fail(path, "vertices but no faces found: expected a mesh with a surface");
        return std::move(mesh_);
    }

  private:
    static constexpr double farthest = 1e6;  // [m]; beyond, single precision has no millimetres to spare
    // Equal for vertices of the same place.
    static uint64_t key_of(const Vec3f& x) {
        uint64_t key = 0;
        for (const float c : {x.x + 0.f, x.y + 0.f, x.z + 0.f})  // -0 is 0
            key = PolygonFans::mixed(key ^ std::bit_cast<uint32_t>(c));
        return key;
    }
    double scale_;
    Mesh mesh_;
    PolygonFans fans_;
    std::vector<uint64_t> keys_;  // of a polygon's corners
};

// "7", "7/1", "7//3", "-1/-1/-1": the vertex, counted from 0.
long long obj_corner(std::string_view word, long long vertices, const std::string& where) {
    const auto index = number_in<long long>(word.substr(0, word.find('/')), where, "a vertex index");
    if (index == 0) fail(where, "vertex index 0, allowed 1 and up or -1 and down");
    return index > 0 ? index - 1 : vertices + index;
}

// Lines that a '\' at their end joins; the ends of lines come after them, so that later ones keep their
// numbers.
std::string joined_lines(std::string_view text) {
    std::string out;
    size_t waiting = 0;
    for (size_t k = 0; k < text.size(); ++k) {
        const size_t end = k + 1 < text.size() && text[k + 1] == '\r' ? k + 2 : k + 1;
        if (text[k] == '\\' && end < text.size() && text[end] == '\n') {
            out += ' ', ++waiting, k = end;
            continue;
        }
        out += text[k];
        if (text[k] == '\n') out.append(waiting, '\n'), waiting = 0;
    }
    return out;
}

Mesh read_obj(std::string_view text, const std::string& path, double scale) {
    // 3ds Max ends a text with a NUL.
    while (text.ends_with('\0')) text.remove_suffix(1);
    std::string joined;
    if (text.find("\\\n") != text.npos || text.find("\\\r\n") != text.npos)
        text = joined = joined_lines(text);
    MeshBuilder mesh(scale);
    Lines lines(text, path);
    std::vector<long long> corners;
    for (std::string_view line; lines.next(line);) {
        Words words(line);
        const std::string_view kind = words.next();
        if (kind == "v") {
            Vec3d p;
            for (double* c : {&p.x, &p.y, &p.z})
                *c = number_in<double>(words.next(), lines.where(), "three coordinates");
            mesh.vertex(p, lines.where());
        } else if (kind == "f") {
            corners.clear();
            for (std::string_view w; !(w = words.next()).empty();)
                corners.push_back(obj_corner(w, mesh.vertices(), lines.where()));
            mesh.polygon(corners, lines.where());
        } else if (line.find('\0') != std::string_view::npos) {
            fail(lines.where(), "not an .obj mesh: the file is binary");
        }
    }
    return mesh.finish(path);
}

enum class PlyType { i8, u8, i16, u16, i32, u32, f32, f64 };

struct PlyProperty {
    std::string name;
    PlyType type{};
    bool list = false;
    PlyType count_type{};
};

struct PlyElement {
    std::string name;
    long long count = 0;
    std::vector<PlyProperty> properties;
};

struct PlyHeader {
    bool binary = false;
    std::vector<PlyElement> elements;
};

PlyType ply_type(std::string_view word, const std::string& where) {
    static const std::unordered_map<std::string_view, PlyType> types{
        {"char", PlyType::i8},    {"int8", PlyType::i8},     {"uchar", PlyType::u8},
        {"uint8", PlyType::u8},   {"short", PlyType::i16},   {"int16", PlyType::i16},
        {"ushort", PlyType::u16}, {"uint16", PlyType::u16},  {"int", PlyType::i32},
        {"int32", PlyType::i32},  {"uint", PlyType::u32},    {"uint32", PlyType::u32},
        {"float", PlyType::f32},  {"float32", PlyType::f32}, {"double", PlyType::f64},
        {"float64", PlyType::f64}};
    const auto found = types.find(word);
    if (found == types.end())
        fail(where, "unknown property type " + shown(word) + ", allowed char … double, int8 … float64");
    return found->second;
}

PlyHeader ply_header(Lines& lines) {
    std::string_view line;
    if (!lines.next(line) || Words(line).next() != "ply")
        fail(lines.where(), "not a .ply file: expected 'ply' first");
    PlyHeader header;
    bool has_format = false;
    while (lines.next(line)) {
        Words words(line);
        const std::string_view kind = words.next();
        if (kind == "format") {
            const std::string_view format = words.next(), version = words.next();
            if (format != "ascii" && format != "binary_little_endian")
                fail(lines.where(), "format " + shown(format) + ", allowed ascii, binary_little_endian");
            if (version != "1.0") fail(lines.where(), "version " + shown(version) + ", allowed 1.0");
            header.binary = format != "ascii";
            has_format = true;
        } else if (kind == "element") {
            PlyElement element;
            element.name = words.next();
            element.count = number_in<long long>(words.next(), lines.where(), "an element count");
            if (element.count < 0)
                fail(lines.where(), "a count of " + std::to_string(element.count) + ", allowed 0 or more");
            header.elements.push_back(element);
        } else if (kind == "property") {
            if (header.elements.empty()) fail(lines.where(), "a property before any element");
            PlyProperty p;
            std::string_view type = words.next();
            if (type == "list") {
                p.list = true;
                p.count_type = ply_type(words.next(), lines.where());
                type = words.next();
            }
            p.type = ply_type(type, lines.where());
            p.name = words.next();
            header.elements.back().properties.push_back(p);
        } else if (kind == "end_header") {
            if (!has_format) fail(lines.where(), "the header names no format");
            return header;
        } else if (kind != "comment" && kind != "obj_info" && !kind.empty()) {
            fail(lines.where(),
                 "unknown header line " + shown(line) + ", allowed format, element, property, comment");
        }
    }
    fail(lines.where(), "the file is cut short: no 'end_header'");
}

// The values behind a header, one after another.
class PlyValues {
  public:
    PlyValues(std::string_view body, bool binary) : rest_(body), binary_(binary) {}

    double number(PlyType type, const std::string& where) {
        if (!binary_) return number_in<double>(word(), where, "a number");
        switch (type) {
            case PlyType::i8:
                return take<int8_t>(where);
            case PlyType::u8:
                return take<uint8_t>(where);
            case PlyType::i16:
                return take<int16_t>(where);
            case PlyType::u16:
                return take<uint16_t>(where);
            case PlyType::i32:
                return take<int32_t>(where);
            case PlyType::u32:
                return take<uint32_t>(where);
            case PlyType::f32:
                return take<float>(where);
            case PlyType::f64:
                return take<double>(where);
        }
        return 0;
    }
    long long integer(PlyType type, const std::string& where, const char* what) {
        const double value = number(type, where);
        if (!(std::abs(value) < 1e15) || value != std::floor(value))
            fail(where, std::string("expected ") + what + ", found " + std::to_string(value));
        return (long long)value;
    }
    // `count` values of at least a byte each (two in ascii, with their blank) must still come.
    void require(long long count, const std::string& where) const {
        const long long left = (long long)(rest_.size());
        if (count > (binary_ ? left : left / 2 + 1))
            fail(where, "the file is cut short or its count absurd: " + std::to_string(count) +
                            " values announced, " + std::to_string(left) + " bytes left");
    }

  private:
    template <class T>
    T take(const std::string& where) {
        if (rest_.size() < sizeof(T)) fail(where, "the file is cut short");
        T value;
        std::memcpy(&value, rest_.data(), sizeof(T));
        rest_.remove_prefix(sizeof(T));
        return value;
    }
    std::string_view word() {
        constexpr const char* blanks = " \t\r\n\v\f";
        const size_t from = std::min(rest_.find_first_not_of(blanks), rest_.size());
        const size_t to = std::min(rest_.find_first_of(blanks, from), rest_.size());
        const std::string_view w = rest_.substr(from, to - from);
        rest_.remove_prefix(to);
        return w;
    }
    std::string_view rest_;
    bool binary_;
};

// What a property is to a mesh: a coordinate (0, 1, 2), the corners of a face, or nothing.
constexpr int no_role = -1, corners_role = 3;
int role_of(const PlyElement& element, const PlyProperty& p) {
    if (element.name == "vertex" && !p.list)
        for (int axis = 0; axis < 3; ++axis)
            if (p.name == std::string(1, char('x' + axis))) return axis;
    const bool names_corners = p.name == "vertex_indices" || p.name == "vertex_index";
    return element.name == "face" && p.list && names_corners ? corners_role : no_role;
}

void require_roles(const PlyElement& element, const std::string& path) {
    bool has[4] = {};
    for (const auto& p : element.properties)
        if (const int role = role_of(element, p); role != no_role) has[role] = true;
    if (element.name == "vertex" && !(has[0] && has[1] && has[2])) fail(path, "its vertices lack x, y or z");
    if (element.name == "face" && !has[corners_role]) fail(path, "its faces lack the list vertex_indices");
}

Mesh read_ply(std::string_view text, const std::string& path, double scale) {
    Lines lines(text, path);
    const PlyHeader header = ply_header(lines);
    PlyValues values(lines.rest(), header.binary);
    MeshBuilder mesh(scale);
    std::vector<long long> corners;
    for (const PlyElement& element : header.elements) {
        require_roles(element, path);
        values.require(element.count, path + ": element " + element.name);
        for (long long row = 0; row < element.count; ++row) {
            const std::string where = path + ": " + element.name + " " + std::to_string(row);
            double position[3] = {0, 0, 0};
            corners.clear();
            for (const auto& p : element.properties) {
                const int role = role_of(element, p);
                const long long n = p.list ? values.integer(p.count_type, where, "the length of a list") : 1;
                if (n < 0) fail(where, "a list of " + std::to_string(n) + " values");
                values.require(n, where);
                for (long long k = 0; k < n; ++k)
                    if (role == corners_role)
                        corners.push_back(values.integer(p.type, where, "a vertex index"));
                    else if (const double value = values.number(p.type, where); role != no_role)
                        position[role] = value;
            }
            if (element.name == "vertex") mesh.vertex({position[0], position[1], position[2]}, where);
            if (element.name == "face") mesh.polygon(corners, where);
        }
    }
    return mesh.finish(path);
}

}  // namespace

Mesh read_mesh(const std::string& path, double scale_to_metres) {
    if (!(scale_to_metres > 0) || !std::isfinite(scale_to_metres))
        fail(path, "a scale of " + std::to_string(scale_to_metres) + ", allowed above 0");
    const std::string extension = ending_of(path);
    if (extension != ".obj" && extension != ".ply" && extension != ".glb")
        fail(path, "mesh format " + shown(extension) +
                       ", allowed .obj, .ply, .glb; of animated meshes .abc, .usda and NAME.####.obj too");
    const std::string text = whole_file(path);
    if (extension == ".glb") {
        Mesh mesh = mesh_of_glb(text, path);
        for (auto& x : mesh.vertices) x = cast<float>(scale_to_metres * cast<double>(x));
        return mesh;
    }
    return extension == ".obj" ? read_obj(text, path, scale_to_metres)
                               : read_ply(text, path, scale_to_metres);
}

}  // namespace wetcurl
