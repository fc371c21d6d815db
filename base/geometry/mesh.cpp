// Reading .obj and .ply meshes; closest point and winding number over a bounding-volume hierarchy.
// Ericson 2005, 5.1.5; Van Oosterom and Strackee 1983, Eq 8; Barill 2018, Eq 6 (order 1).
#include "base/geometry/mesh.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <numeric>
#include <string_view>
#include <unordered_map>

namespace wetcurl {

static_assert(std::endian::native == std::endian::little, "binary .ply is read in place");

namespace {

// ---- reading ----

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
    // A denormal that underflows is as good as zero.
    if (std::is_floating_point_v<T> && error == std::errc::result_out_of_range && std::abs(value) <= T(1))
        return value;
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
        for (size_t k = 1; k + 1 < corners.size(); ++k) {
            const std::array<int, 3> t{int(corners[0]), int(corners[k]), int(corners[k + 1])};
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
    double scale_;
    Mesh mesh_;
};

// "7", "7/1", "7//3", "-1/-1/-1": the vertex, counted from 0.
long long obj_corner(std::string_view word, long long vertices, const std::string& where) {
    const auto index = number_in<long long>(word.substr(0, word.find('/')), where, "a vertex index");
    if (index == 0) fail(where, "vertex index 0, allowed 1 and up or -1 and down");
    return index > 0 ? index - 1 : vertices + index;
}

Mesh read_obj(std::string_view text, const std::string& path, double scale) {
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

Mesh read_ply(std::string_view text, const std::string& path, double scale) {
    Lines lines(text, path);
    const PlyHeader header = ply_header(lines);
    PlyValues values(lines.rest(), header.binary);
    MeshBuilder mesh(scale);
    std::vector<long long> corners;
    for (const PlyElement& element : header.elements) {
        const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
        values.require(element.count, path + ": element " + element.name);
        bool has_corners = false, has_position[3] = {false, false, false};
        for (const auto& p : element.properties) {
            for (int axis = 0; axis < 3; ++axis)
                has_position[axis] |= !p.list && p.name == std::string(1, char('x' + axis));
            has_corners |= p.list && (p.name == "vertex_indices" || p.name == "vertex_index");
        }
        if (is_vertex && !(has_position[0] && has_position[1] && has_position[2]))
            fail(path, "its vertices lack x, y or z");
        if (is_face && !has_corners) fail(path, "its faces lack the list vertex_indices");
        for (long long row = 0; row < element.count; ++row) {
            const std::string where = path + ": " + element.name + " " + std::to_string(row);
            double position[3] = {0, 0, 0};
            for (const auto& p : element.properties) {
                const long long n = p.list ? values.integer(p.count_type, where, "the length of a list") : 1;
                if (n < 0) fail(where, "a list of " + std::to_string(n) + " values");
                values.require(n, where);
                const bool of_corners =
                    is_face && p.list && (p.name == "vertex_indices" || p.name == "vertex_index");
                if (of_corners) corners.clear();
                for (long long k = 0; k < n; ++k) {
                    if (of_corners) {
                        corners.push_back(values.integer(p.type, where, "a vertex index"));
                        continue;
                    }
                    const double value = values.number(p.type, where);
                    if (!p.list && p.name.size() == 1 && p.name[0] >= 'x' && p.name[0] <= 'z')
                        position[p.name[0] - 'x'] = value;
                }
            }
            if (is_vertex) mesh.vertex({position[0], position[1], position[2]}, where);
            if (is_face) mesh.polygon(corners, where);
        }
    }
    return mesh.finish(path);
}

// ---- geometry ----

double component(const Vec3d& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }
Vec3d lower(const Vec3d& a, const Vec3d& b) {
    return {std::min(a.x, b.x), std::min(a.y, b.y), std::min(a.z, b.z)};
}
Vec3d upper(const Vec3d& a, const Vec3d& b) {
    return {std::max(a.x, b.x), std::max(a.y, b.y), std::max(a.z, b.z)};
}

Bounds empty_bounds() {
    constexpr double inf = std::numeric_limits<double>::infinity();
    return {{inf, inf, inf}, {-inf, -inf, -inf}};
}

// Halving 2^31 triangles leaves fewer levels than this; a level keeps one node waiting.
constexpr int deepest = 64;

double squared_distance_to_box(const Vec3d& x, const Vec3d& low, const Vec3d& high) {
    const Vec3d d = x - lower(upper(x, low), high);
    return dot(d, d);
}

// Barycentric weights of the point of triangle abc nearest to x.
Vec3d closest_weights(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& x) {
    const Vec3d ab = b - a, ac = c - a, ax = x - a, bx = x - b, cx = x - c;
    const double d1 = dot(ab, ax), d2 = dot(ac, ax), d3 = dot(ab, bx), d4 = dot(ac, bx), d5 = dot(ab, cx),
                 d6 = dot(ac, cx);
    if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
    if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
    if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
    const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
    const double bc = (d4 - d3) + (d5 - d6);
    if (va <= 0 && d4 >= d3 && d5 >= d6) return {0, 1 - (d4 - d3) / bc, (d4 - d3) / bc};
    const double sum = va + vb + vc;
    return {1 - vb / sum - vc / sum, vb / sum, vc / sum};
}

// Solid angle of abc seen from the origin (Van Oosterom and Strackee 1983, Eq 8).
double solid_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const double la = norm(a), lb = norm(b), lc = norm(c);
    const double volume = dot(a, cross(b, c));
    // In the triangle's own plane the angle has no side.
    if (volume == 0) return 0;
    return 2 * std::atan2(volume, la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

}  // namespace

Mesh read_mesh(const std::string& path, double scale_to_metres) {
    if (!(scale_to_metres > 0) || !std::isfinite(scale_to_metres))
        fail(path, "a scale of " + std::to_string(scale_to_metres) + ", allowed above 0");
    std::string extension = std::filesystem::path(path).extension().string();
    for (char& c : extension) c = char(std::tolower(static_cast<unsigned char>(c)));
    if (extension != ".obj" && extension != ".ply")
        fail(path, "mesh format " + shown(extension) + ", allowed .obj, .ply");
    const std::string text = whole_file(path);
    return extension == ".obj" ? read_obj(text, path, scale_to_metres)
                               : read_ply(text, path, scale_to_metres);
}

int boundary_edges(const Mesh& mesh) {
    std::vector<uint64_t> edges;
    for (const auto& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) {
            const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
            edges.push_back(uint64_t(a) << 32 | uint64_t(b));
        }
    std::sort(edges.begin(), edges.end());
    int lone = 0;
    for (size_t i = 0, end = 0; i < edges.size(); i = end) {
        while (end < edges.size() && edges[end] == edges[i]) ++end;
        lone += end - i == 1;
    }
    return lone;
}

Bounds bounding_box(const Mesh& mesh) {
    Bounds box = empty_bounds();
    for (const auto& t : mesh.triangles)
        for (int corner : t) {
            const Vec3d p = cast<double>(mesh.vertices[size_t(corner)]);
            box = {lower(box.low, p), upper(box.high, p)};
        }
    return box;
}

MeshDistance::MeshDistance(const Mesh& mesh) {
    std::vector<Triangle> given;
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto corner = [&](size_t k) {
            return cast<double>(mesh.vertices[size_t(mesh.triangles[t][k])]);
        };
        const Triangle abc{corner(0), corner(1), corner(2)};
        given.push_back(abc);
        // A triangle without an area has no surface to be near to, and no weights.
        const Vec3d ab = abc.b - abc.a, ac = abc.c - abc.a, bc = abc.c - abc.b;
        const double longest = std::max({dot(ab, ab), dot(ac, ac), dot(bc, bc)});
        if (norm(cross(ab, ac)) > 1e-12 * longest) original_.push_back(int(t));
    }
    if (original_.empty())
        throw Error("distance to a mesh: none of its " + std::to_string(given.size()) +
                    " triangles has an area");
    nodes_.reserve(original_.size());
    nodes_.emplace_back();
    build(0, 0, int(original_.size()), given);
    place_.assign(given.size(), -1);
    for (int t : original_) {
        place_[size_t(t)] = int(triangles_.size());
        triangles_.push_back(given[size_t(t)]);
    }
}

void MeshDistance::build(int node, int first, int count, const std::vector<Triangle>& given) {
    constexpr int leaf = 4;
    const auto begin = original_.begin() + first, end = begin + count;
    const auto centroid = [&](int t) {
        return (1.0 / 3) * (given[size_t(t)].a + given[size_t(t)].b + given[size_t(t)].c);
    };
    nodes_[size_t(node)] = summary(std::vector<int>(begin, end), given);
    if (count <= leaf) {
        nodes_[size_t(node)].first = first;
        nodes_[size_t(node)].count = count;
        return;
    }
    const Vec3d size = nodes_[size_t(node)].high - nodes_[size_t(node)].low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const int half = count / 2;
    std::nth_element(begin, begin + half, end, [&](int s, int t) {
        return component(centroid(s), axis) < component(centroid(t), axis);
    });
    const int children = int(nodes_.size());
    nodes_[size_t(node)].first = children;
    nodes_[size_t(node)].count = 0;
    nodes_.resize(nodes_.size() + 2);
    build(children, first, half, given);
    build(children + 1, first + half, count - half, given);
}

MeshDistance::Node MeshDistance::summary(const std::vector<int>& members,
                                         const std::vector<Triangle>& given) {
    const Bounds none = empty_bounds();
    Node node{none.low, none.high, {0, 0, 0}, {0, 0, 0}, 0, 0, 0};
    double total = 0;
    for (int t : members) {
        const auto& [a, b, c] = given[size_t(t)];
        const Vec3d area = 0.5 * cross(b - a, c - a);
        node.area += area;
        node.centre += (norm(area) / 3) * (a + b + c);
        total += norm(area);
        node.low = lower(node.low, lower(a, lower(b, c)));
        node.high = upper(node.high, upper(a, upper(b, c)));
    }
    node.centre = (1 / total) * node.centre;
    for (int t : members)
        for (const Vec3d& p : {given[size_t(t)].a, given[size_t(t)].b, given[size_t(t)].c})
            node.radius = std::max(node.radius, norm(p - node.centre));
    return node;
}

MeshDistance::Closest MeshDistance::closest(const Vec3d& x, int guess) const {
    double least = std::numeric_limits<double>::infinity();
    Closest best;
    const auto visit = [&](int t) {
        const auto& [a, b, c] = triangles_[size_t(t)];
        const Vec3d w = closest_weights(a, b, c, x);
        const Vec3d p = w.x * a + w.y * b + w.z * c;
        if (const double d = dot(x - p, x - p); d < least) {
            least = d;
            best = {0, p, original_[size_t(t)], w};
        }
    };
    if (guess >= 0 && guess < int(place_.size()) && place_[size_t(guess)] >= 0) visit(place_[size_t(guess)]);
    struct Waiting {
        int node;
        double near;
    } stack[deepest];
    int top = 0;
    const auto near = [&](int n) {
        return squared_distance_to_box(x, nodes_[size_t(n)].low, nodes_[size_t(n)].high);
    };
    stack[top++] = {0, near(0)};
    while (top > 0) {
        const Waiting next = stack[--top];
        if (next.near >= least) continue;
        const Node& node = nodes_[size_t(next.node)];
        for (int t = node.first; t < node.first + node.count; ++t) visit(t);
        if (node.count > 0) continue;
        Waiting left{node.first, near(node.first)}, right{node.first + 1, near(node.first + 1)};
        if (left.near < right.near) std::swap(left, right);
        stack[top++] = left;  // the farther one waits
        stack[top++] = right;
    }
    best.distance = std::sqrt(least);
    return best;
}

double MeshDistance::winding_number(const Vec3d& x) const {
    // Barill 2018: a cluster seen from beyond beta times its radius is a dipole.
    constexpr double beta = 2;
    double sum = 0;
    int stack[deepest], top = 0;
    stack[top++] = 0;
    while (top > 0) {
        const Node& node = nodes_[size_t(stack[--top])];
        const Vec3d d = node.centre - x;
        if (const double r2 = dot(d, d); r2 > beta * beta * node.radius * node.radius) {
            sum += dot(d, node.area) / (r2 * std::sqrt(r2));
            continue;
        }
        for (int t = node.first; t < node.first + node.count; ++t) {
            const auto& [a, b, c] = triangles_[size_t(t)];
            sum += solid_angle(a - x, b - x, c - x);
        }
        if (node.count > 0) continue;
        stack[top++] = node.first;
        stack[top++] = node.first + 1;
    }
    return sum / (4 * std::numbers::pi);
}

}  // namespace wetcurl
