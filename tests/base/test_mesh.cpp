// Mesh readers against each other and against bad input; closest points and winding numbers against plain
// loops.
#include <cstring>
#include <numbers>

#include "base/geometry/mesh.h"
#include "base/geometry/mesh_winding.h"
#include "base/geometry/shapes.h"
#include "scratch.h"

namespace wetcurl {
namespace {

using testing::expect_error;
using testing::Random;
using testing::Scratch;

template <class T>
void put(std::string& out, T value) {
    char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    out.append(bytes, sizeof(T));
}

// A pyramid over a square, in centimetres: one quad and four triangles.
const std::vector<std::array<float, 3>> points{{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}, {0, 1.5f, 0}};
const std::vector<std::vector<int>> faces{{0, 1, 2, 3}, {1, 0, 4}, {2, 1, 4}, {3, 2, 4}, {0, 3, 4}};

std::string obj_text(const char* style) {
    std::stringstream out;
    out << "# a pyramid\r\nmtllib none.mtl\no pyramid\n";
    for (const auto& p : points)
        out << "v " << p[0] << " " << p[1] << "\t" << p[2]
            << (style == std::string("v/vt/vn") ? " 1.0\n" : "\n");
    out << "vt 0 0\nvn 0 1 0\ns off\n";
    for (const auto& f : faces) {
        out << "f";
        for (int c : f) {
            out << " ";
            if (style == std::string("v")) out << c + 1;
            if (style == std::string("v/vt/vn")) out << c + 1 << "/1/1";
            if (style == std::string("v//vn")) out << c + 1 << "//1";
            if (style == std::string("negative")) out << c - int(points.size()) << "/-1/-1";
        }
        out << " \r\n";
    }
    return out.str();
}

std::string ply_header(const char* format, const char* coordinate = "float",
                       const char* list = "list uchar int") {
    return std::string("ply\nformat ") + format + " 1.0\ncomment a pyramid\nelement vertex 5\nproperty " +
           coordinate + " x\nproperty " + coordinate + " y\nproperty " + coordinate +
           " z\nproperty uchar red\nelement face 5\nproperty " + list +
           " vertex_indices\nproperty float quality\nend_header\n";
}
std::string ascii_ply() {
    std::stringstream out;
    out << ply_header("ascii");
    for (const auto& p : points) out << p[0] << " " << p[1] << " " << p[2] << " 255\n";
    for (const auto& f : faces) {
        out << f.size();
        for (int c : f) out << " " << c;
        out << " 0.5\n";
    }
    return out.str();
}
template <class Coordinate, class Count, class Index>
std::string binary_ply(const char* coordinate, const char* list) {
    std::string out = ply_header("binary_little_endian", coordinate, list);
    for (const auto& p : points) {
        for (float c : p) put(out, Coordinate(c));
        put(out, uint8_t(255));
    }
    for (const auto& f : faces) {
        put(out, Count(f.size()));
        for (int c : f) put(out, Index(c));
        put(out, 0.5f);
    }
    return out;
}

// Triangles of the pyramid under two nodes: one turns by a quarter about y and makes it half as large, the
// other moves it; positions are 16 bytes apart, indices of two bytes.
std::string glb(const char* more = "") {
    std::string binary;
    for (const auto& p : points) {
        for (const float x : {2 * -p[2], 2 * (p[1] - 1), 2 * p[0]}) put(binary, x);
        put(binary, 0.f);
    }
    int corners = 0;
    for (const auto& f : faces)
        for (size_t k = 1; k + 1 < f.size(); ++k)
            for (const size_t c : {size_t(0), k, k + 1}) put(binary, uint16_t(f[c])), ++corners;
    binary.resize((binary.size() + 3) / 4 * 4);
    std::string json =
        std::string(
            R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[1]}],"nodes":[)"
            R"({"mesh":0,"scale":[0.5,0.5,0.5],"rotation":[0,0.70710678118654752,0,0.70710678118654752]},)"
            R"({"children":[0],"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,1,0,1]}],"meshes":[{"primitives":[)"
            R"({"attributes":{"POSITION":0},"indices":1}]}],"accessors":[)"
            R"({"bufferView":0,"componentType":5126,"count":5,"type":"VEC3"},)"
            R"({"bufferView":1,"componentType":5123,"count":)") +
        std::to_string(corners) +
        R"(,"type":"SCALAR"}],"bufferViews":[{"buffer":0,"byteLength":80,"byteStride":16},)"
        R"({"buffer":0,"byteOffset":80,"byteLength":36}],"buffers":[{"byteLength":116}])" +
        more + "}";
    json.resize((json.size() + 3) / 4 * 4, ' ');
    std::string out = "glTF";
    put(out, uint32_t(2)), put(out, uint32_t(28 + json.size() + binary.size()));
    put(out, uint32_t(json.size())), out += "JSON" + json;
    put(out, uint32_t(binary.size())), out += std::string("BIN\0", 4) + binary;
    return out;
}

TEST(MeshFiles, glb_names_what_it_does_not_read) {
    const Scratch scratch;
    expect_error(
        [&] {
            read_mesh(scratch.file("m.glb", glb(R"(,"extensionsRequired":["KHR_draco_mesh_compression"])")),
                      1);
        },
        {"m.glb", "KHR_draco_mesh_compression", "without compression"});
    expect_error([&] { read_mesh(scratch.file("m.glb", "{\"asset\": {}, \"scene\": 0}"), 1); },
                 {"m.glb", "glTF"});
}

TEST(MeshFiles, all_readers_agree) {
    const Scratch scratch;
    const std::vector<std::string> files{
        scratch.file("plain.obj", obj_text("v")),
        scratch.file("full.obj", obj_text("v/vt/vn")),
        scratch.file("normals.OBJ", obj_text("v//vn")),
        scratch.file("negative.obj", obj_text("negative")),
        scratch.file("ascii.ply", ascii_ply()),
        scratch.file("float.ply", binary_ply<float, uint8_t, int32_t>("float", "list uchar int")),
        scratch.file("double.ply", binary_ply<double, int32_t, uint16_t>("double", "list int ushort")),
        scratch.file("nodes.glb", glb())};
    for (const auto& path : files) {
        const Mesh mesh = read_mesh(path, 0.01);
        ASSERT_EQ(mesh.vertices.size(), 5u) << path;
        for (size_t i = 0; i < 5; ++i)
            for (int axis = 0; axis < 3; ++axis)
                EXPECT_NEAR((&mesh.vertices[i].x)[axis], 0.01f * points[i][size_t(axis)], 2e-9) << path;
        const std::vector<std::array<int, 3>> wanted{{0, 1, 2}, {0, 2, 3}, {1, 0, 4},
                                                     {2, 1, 4}, {3, 2, 4}, {0, 3, 4}};
        EXPECT_EQ(mesh.triangles, wanted) << path;
        EXPECT_EQ(boundary_edges(mesh), 0) << path;
    }
}

// A quad that is there twice is split alike, whichever corner and turn its faces begin with.
TEST(MeshFiles, doubled_polygons_are_doubled_triangles_and_a_nul_may_end_a_text) {
    const Scratch scratch;
    std::string text = obj_text("v") + "v -1 0 -1\nv 1 0 -1\nv 1 0 1\nv -1 0 1\nf 9 8 7 6\nf 3 2 1 4\n";
    const Mesh mesh = read_mesh(scratch.file("m.obj", text + std::string(1, '\0')), 1);
    Winding winding;
    EXPECT_EQ(boundary_edges(consistently_wound(mesh, &winding)), 0);
    EXPECT_EQ(winding.doubled, 4u);
    EXPECT_EQ(winding.turned, 0u);
}

TEST(MeshFiles, an_obj_line_goes_on_after_a_backslash_and_later_lines_keep_their_numbers) {
    const Scratch scratch;
    for (const char* end : {"\n", "\r\n"}) {
        const std::string text =
            std::string("v 0 0 0\nv 1 0 \\") + end + "0\nv 0 1 0\nf 1 \\" + end + "2 \\" + end + "3\n";
        EXPECT_EQ(read_mesh(scratch.file("m.obj", text), 1).triangles,
                  (std::vector<std::array<int, 3>>{{0, 1, 2}}));
        expect_error([&] { read_mesh(scratch.file("n.obj", text + "f 1 2 9\n"), 1); }, {"n.obj:8"});
    }
}

TEST(MeshFiles, polygons_are_fanned_and_repeated_corners_dropped) {
    const Scratch scratch;
    const Mesh mesh = read_mesh(
        scratch.file("m.obj", "v 0 0 0\nv 1 0 0\nv 2 1 0\nv 1 2 0\nv 0 2 0\nf 1 2 3 4 5\nf 1 1 2\n"), 1);
    EXPECT_EQ(mesh.triangles, (std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
    EXPECT_EQ(boundary_edges(mesh), 5);
}

TEST(MeshFiles, negative_indices_count_back_from_where_they_stand) {
    const Scratch scratch;
    const Mesh mesh =
        read_mesh(scratch.file("m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -4 -3 -1\n"), 1);
    EXPECT_EQ(mesh.triangles, (std::vector<std::array<int, 3>>{{0, 1, 2}, {0, 1, 3}}));
}

struct Bad {
    const char* name;
    std::string text;
    std::vector<std::string> parts;  // of the message
};

std::string ply_of(const std::string& head, const std::string& body = "") {
    return "ply\nformat ascii 1.0\n" + head + "end_header\n" + body;
}
const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
const std::string list = "property list uchar int vertex_indices\n";
const std::string triangle = "element vertex 3\n" + xyz + "element face 1\n" + list;

std::vector<Bad> bad_files() {
    return {
        {"empty.obj", "", {"empty"}},
        {"empty.ply", "", {"empty"}},
        {"foreign.obj", "once upon a time\nthere was a hair\n", {"no vertices"}},
        {"binary.obj",
         std::string("\x7f"
                     "ELF\0\0\0\0\n",
                     10),
         {"binary"}},
        {"no_faces.obj", "v 0 0 0\nv 1 0 0\n", {"no faces"}},
        {"cut_vertex.obj", "v 0 0 0\nv 1 0", {":2", "cut short", "three coordinates"}},
        {"letter.obj", "v 0 zero 0\n", {":1", "'zero'", "coordinates"}},
        {"nan.obj", "v 0 0 0\nv nan 0 0\nv 0 1 0\nf 1 2 3\n", {":2", "nan"}},
        {"inf.obj", "v 0 0 0\nv 0 inf 0\nv 0 1 0\nf 1 2 3\n", {":2", "inf"}},
        {"far.obj", "v 0 0 1e30\n", {":1", "1000000"}},
        {"overflow.obj", "v 0 0 1e999\n", {":1", "inf", "1000000"}},
        {"beyond.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", {":4", "number 4 of 3"}},
        {"zero.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", {":4", "index 0"}},
        {"negative.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -4 -2 -1\n", {":4", "out of range"}},
        {"huge_index.obj", "v 0 0 0\nf 1 1 99999999999999999999\n", {":2", "vertex index"}},
        {"two_corners.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", {":3", "2 corners", "3 or more"}},
        {"word.obj", "v 0 0 0\nf a b c\n", {":2", "'a'"}},
        {"foreign.ply", "solid cube\n", {"not a .ply"}},
        {"big.ply",
         "ply\nformat binary_big_endian 1.0\nend_header\n",
         {":2", "binary_big_endian", "binary_little_endian"}},
        {"version.ply", "ply\nformat ascii 2.0\nend_header\n", {":2", "'2.0'", "1.0"}},
        {"no_format.ply", "ply\nelement vertex 0\nend_header\n", {"no format"}},
        {"cut_header.ply", "ply\nformat ascii 1.0\nelement vertex 3\n", {"cut short", "end_header"}},
        {"unknown_line.ply", "ply\nformat ascii 1.0\nelephant 3\n", {":3", "elephant"}},
        {"type.ply", ply_of("element vertex 1\nproperty quaternion x\n"), {":4", "'quaternion'"}},
        {"orphan.ply", ply_of("property float x\n"), {":3", "before any element"}},
        {"no_x.ply", ply_of("element vertex 1\nproperty float y\n", "0\n"), {"lack x, y or z"}},
        {"no_list.ply",
         ply_of("element vertex 1\n" + xyz + "element face 1\nproperty int a\n", "0 0 0\n1\n"),
         {"vertex_indices"}},
        {"negative_count.ply", ply_of("element vertex -5\n" + xyz), {":3", "-5"}},
        {"absurd_count.ply",
         ply_of("element vertex 900000000000\n" + xyz, "0 0 0\n"),
         {"vertex", "900000000000", "absurd"}},
        {"overflow_count.ply",
         ply_of("element vertex 99999999999999999999\n" + xyz),
         {":3", "99999999999999999999"}},
        {"cut_body.ply", ply_of(triangle, "0 0 0\n1 0 0\n"), {"vertex 2", "cut short"}},
        {"cut_face.ply", ply_of(triangle, "0 0 0\n1 0 0\n0 1 0\n3 0 1"), {"face 0", "cut short"}},
        {"long_list.ply",
         ply_of(triangle, "0 0 0\n1 0 0\n0 1 0\n2000000000 0 1\n"),
         {"face 0", "2000000000"}},
        {"negative_list.ply", ply_of(triangle, "0 0 0\n1 0 0\n0 1 0\n-3 0 1 2\n"), {"face 0", "-3"}},
        {"half_index.ply", ply_of(triangle, "0 0 0\n1 0 0\n0 1 0\n3 0 1.5 2\n"), {"face 0", "1.5"}},
        {"beyond.ply", ply_of(triangle, "0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n"), {"face 0", "number 4 of 3"}},
        {"negative.ply", ply_of(triangle, "0 0 0\n1 0 0\n0 1 0\n3 0 1 -1\n"), {"face 0", "out of range"}},
        {"nan.ply", ply_of(triangle, "0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n"), {"vertex 1", "nan"}},
        {"no_faces.ply", ply_of("element vertex 1\n" + xyz, "0 0 0\n"), {"no faces"}},
        {"no_vertices.ply", ply_of("element vertex 0\n" + xyz), {"no vertices"}},
    };
}

TEST(MeshFiles, every_bad_file_is_an_error_with_its_name_and_what_is_wrong) {
    const Scratch scratch;
    for (const Bad& bad : bad_files()) {
        SCOPED_TRACE(bad.name);
        const std::string path = scratch.file(bad.name, bad.text);
        expect_error([&] { read_mesh(path, 1); }, {path});
        for (const auto& part : bad.parts) expect_error([&] { read_mesh(path, 1); }, {part});
    }
}

TEST(MeshFiles, missing_files_folders_foreign_names_and_bad_scales_are_errors) {
    const Scratch scratch;
    expect_error([&] { read_mesh(scratch.path("none.obj"), 1); }, {"none.obj", "no such file"});
    std::filesystem::create_directory(scratch.path("folder.ply"));
    expect_error([&] { read_mesh(scratch.path("folder.ply"), 1); }, {"folder.ply", "cannot be read"});
    expect_error([&] { read_mesh(scratch.file("m.stl", "solid"), 1); },
                 {"m.stl", "'.stl'", ".obj, .ply, .glb"});
    const std::string good = scratch.file("m.obj", obj_text("v"));
    for (double scale : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()})
        expect_error([&] { read_mesh(good, scale); }, {"m.obj", "scale"});
}

TEST(MeshFiles, binary_ply_with_a_coordinate_that_is_no_number_is_an_error) {
    const Scratch scratch;
    std::string text = binary_ply<float, uint8_t, int32_t>("float", "list uchar int");
    const float nan = std::numeric_limits<float>::quiet_NaN();
    std::memcpy(text.data() + text.find("end_header\n") + 11 + 13, &nan,
                4);  // x of vertex 1: a row is 13 bytes
    expect_error([&] { read_mesh(scratch.file("nan.ply", text), 1); }, {"nan.ply", "vertex 1", "nan"});
}

// Wherever it is cut, an error or (for text, where nothing marks the end) a mesh; never a crash.
TEST(MeshFiles, cut_anywhere_a_binary_file_is_an_error) {
    const Scratch scratch;
    const std::pair<const char*, std::string> files[] = {
        {"cut.ply", binary_ply<float, uint8_t, int32_t>("float", "list uchar int")}, {"cut.glb", glb()}};
    for (const auto& [name, whole] : files) {
        for (size_t n = 0; n < whole.size(); ++n) {
            const std::string path = scratch.file(name, whole.substr(0, n));
            expect_error([&] { read_mesh(path, 1); }, {name});
        }
        EXPECT_NO_THROW(read_mesh(scratch.file(name, whole), 1));
    }
}

TEST(MeshFiles, with_any_byte_changed_a_file_is_a_mesh_or_an_error) {
    const Scratch scratch;
    int errors = 0;
    for (const std::string& whole : {obj_text("v/vt/vn"), ascii_ply(),
                                     binary_ply<float, uint8_t, int32_t>("float", "list uchar int"), glb()}) {
        const char* name = whole.starts_with("ply") ? "m.ply" : whole.starts_with("glTF") ? "m.glb" : "m.obj";
        for (size_t n = 0; n < whole.size(); n += 3)
            for (char c : {'\0', '-', '9', '\n', '\xff'}) {
                std::string changed = whole;
                changed[n] = c;
                const std::string path = scratch.file(name, changed);
                try {
                    const Mesh mesh = read_mesh(path, 1);
                    for (const auto& t : mesh.triangles)
                        for (int corner : t) ASSERT_LT(size_t(corner), mesh.vertices.size());
                } catch (const Error&) {
                    ++errors;
                }
            }
    }
    EXPECT_GT(errors, 300);
}

TEST(RealHeads, are_read_with_their_known_size_and_openness) {
    const std::string data = std::string(WETCURL_SHARED_DIR) + "/data/";
    if (!std::filesystem::exists(data)) GTEST_SKIP() << "SKIP: no " << data;
    const Mesh head = read_mesh(data + "female_head.obj", 0.01), wig = read_mesh(data + "wig_head.obj", 0.01);
    EXPECT_EQ(head.vertices.size(), 10822u);
    EXPECT_EQ(head.triangles.size(), 21510u);
    EXPECT_EQ(boundary_edges(head), 134);
    EXPECT_EQ(wig.vertices.size(), 964u);
    EXPECT_EQ(wig.triangles.size(), 1920u);  // 896 quads, 128 triangles
    EXPECT_EQ(boundary_edges(wig), 0);
    const Bounds box = bounding_box(head);
    EXPECT_GT(box.high.y - box.low.y, 0.2);
    EXPECT_LT(box.high.y - box.low.y, 0.6);
}

// ---- distance ----

double distance_to_segment(const Vec3d& a, const Vec3d& b, const Vec3d& x) {
    const double t = std::clamp(dot(x - a, b - a) / dot(b - a, b - a), 0.0, 1.0);
    return norm(x - (a + t * (b - a)));
}
// By another route than the one under test: the plane's foot where it lies within, else the nearest edge.
double distance_to_triangle(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& x) {
    const Vec3d n = normalized(cross(b - a, c - a), Vec3d{0, 0, 0});
    const double height = dot(x - a, n);
    const Vec3d foot = x - height * n;
    const bool within = dot(cross(b - a, foot - a), n) >= 0 && dot(cross(c - b, foot - b), n) >= 0 &&
                        dot(cross(a - c, foot - c), n) >= 0;
    return within ? std::abs(height)
                  : std::min({distance_to_segment(a, b, x), distance_to_segment(b, c, x),
                              distance_to_segment(c, a, x)});
}

Mesh soup(int triangles, unsigned seed) {
    Random random(seed);
    Mesh mesh;
    for (int t = 0; t < triangles; ++t) {
        const Vec3d centre = random.vector();
        for (int k = 0; k < 3; ++k) mesh.vertices.push_back(cast<float>(centre + random.vector(0.2)));
        mesh.triangles.push_back({3 * t, 3 * t + 1, 3 * t + 2});
    }
    return mesh;
}

TEST(MeshDistance, closest_point_equals_a_loop_over_all_triangles_with_and_without_a_guess) {
    const Mesh mesh = soup(300, 1);
    const MeshDistance surface(mesh);
    Random random(2);
    const auto corner = [&](size_t t, size_t k) {
        return cast<double>(mesh.vertices[size_t(mesh.triangles[t][k])]);
    };
    for (int k = 0; k < 1000; ++k) {
        const Vec3d x = random.vector(1.5);
        double least = 1e9;
        for (size_t t = 0; t < mesh.triangles.size(); ++t)
            least = std::min(least, distance_to_triangle(corner(t, 0), corner(t, 1), corner(t, 2), x));
        const auto c = surface.closest(x), guessed = surface.closest(x, k % 300);
        EXPECT_NEAR(c.distance, least, 1e-12);
        EXPECT_EQ(c.distance, guessed.distance);
        EXPECT_NEAR(norm(c.point - x), c.distance, 1e-12);
        const Vec3d w = c.barycentric;
        EXPECT_NEAR(w.x + w.y + w.z, 1, 1e-12);
        EXPECT_GE(std::min({w.x, w.y, w.z}), -1e-12);
        const size_t t = size_t(c.triangle);
        EXPECT_LT(norm(w.x * corner(t, 0) + w.y * corner(t, 1) + w.z * corner(t, 2) - c.point), 1e-12);
    }
}

TEST(MeshDistance, finds_a_point_of_the_surface_at_distance_zero) {
    const Mesh mesh = triangulated(Sphere{0.1}, 32);
    const MeshDistance surface(mesh);
    for (const Vec3f& v : mesh.vertices) EXPECT_LT(surface.closest(cast<double>(v)).distance, 1e-15);
}

TEST(MeshDistance, leaves_out_triangles_without_area) {
    Mesh mesh = soup(20, 3);
    const auto wanted = MeshDistance(mesh).closest({0.1, 0.2, 0.3});
    mesh.triangles.insert(mesh.triangles.begin(), {{0, 0, 1}, {5, 5, 5}});
    const auto found = MeshDistance(mesh).closest({0.1, 0.2, 0.3}, 0);
    EXPECT_EQ(found.distance, wanted.distance);
    EXPECT_EQ(found.triangle, wanted.triangle + 2);
    expect_error([] { MeshDistance(Mesh{}); }, {"area"});
    expect_error([] { MeshDistance(Mesh{{{0, 0, 0}, {1, 1, 1}}, {{0, 1, 0}}}); }, {"1 triangles", "area"});
}

// Sum of signed solid angles of spherical triangles by L'Huilier's theorem: no arctangent of two arguments.
double plain_winding_number(const Mesh& mesh, const Vec3d& x) {
    double sum = 0;
    for (const auto& t : mesh.triangles) {
        Vec3d u[3];
        for (int k = 0; k < 3; ++k)
            u[k] = normalized(cast<double>(mesh.vertices[size_t(t[size_t(k)])]) - x, Vec3d{0, 0, 0});
        const auto arc = [&](int a, int b) { return 2 * std::asin(std::min(1.0, 0.5 * norm(u[a] - u[b]))); };
        const double a = arc(1, 2), b = arc(2, 0), c = arc(0, 1), s = (a + b + c) / 2;
        const double e =
            4 * std::atan(std::sqrt(std::max(0.0, std::tan(s / 2) * std::tan((s - a) / 2) *
                                                      std::tan((s - b) / 2) * std::tan((s - c) / 2))));
        sum += dot(u[0], cross(u[1], u[2])) > 0 ? e : -e;
    }
    return sum / (4 * std::numbers::pi);
}

TEST(WindingNumber, is_one_inside_and_zero_outside_a_closed_mesh) {
    const MeshDistance surface(triangulated(Capsule{0.2, 0.1}, 64));
    Random random(4);
    int inside = 0;
    for (int k = 0; k < 2000; ++k) {
        const Vec3d x = random.vector(0.35);
        const double phi = distance(Capsule{0.2, 0.1}, x).phi;
        if (std::abs(phi) < 1e-3) continue;                             // within the sagitta of the triangles
        EXPECT_NEAR(surface.winding_number(x), phi < 0 ? 1 : 0, 0.02);  // of the dipoles
        inside += phi < 0;
    }
    EXPECT_GT(inside, 50);
}

TEST(WindingNumber, with_dipoles_is_near_the_sum_of_solid_angles_of_an_open_mesh) {
    Mesh mesh = triangulated(Sphere{0.3}, 64);
    mesh.triangles.resize(mesh.triangles.size() * 2 / 3);  // a slice is missing
    ASSERT_GT(boundary_edges(mesh), 10);
    const MeshDistance surface(mesh);
    Random random(5);
    double most = 0, least = 1;
    for (int k = 0; k < 300; ++k) {
        const Vec3d x = random.vector(0.5);
        const double plain = plain_winding_number(mesh, x);
        EXPECT_NEAR(surface.winding_number(x), plain, 0.02);
        most = std::max(most, plain);
        least = std::min(least, plain);
    }
    EXPECT_GT(most, 0.7);
    EXPECT_LT(least, 0.2);
}

TEST(WindingNumber, counts_nested_surfaces) {
    Mesh mesh = triangulated(Sphere{0.3}, 32);
    const Mesh inner = triangulated(Sphere{0.1}, 32);
    const int offset = int(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), inner.vertices.begin(), inner.vertices.end());
    for (const auto& t : inner.triangles)
        mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
    const MeshDistance surface(mesh);
    EXPECT_NEAR(surface.winding_number({0.01, 0.02, 0}), 2, 0.04);
    EXPECT_NEAR(surface.winding_number({0.2, 0.02, 0}), 1, 0.02);
    EXPECT_TRUE(surface.inside({0.01, 0.02, 0}));
}

TEST(Bounds, are_those_of_the_vertices_in_use) {
    const Mesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {99, 99, 99}}, {{0, 1, 2}}};
    EXPECT_EQ(norm(bounding_box(mesh).high - Vec3d{1, 2, 0}), 0);
    EXPECT_EQ(norm(bounding_box(mesh).low), 0);
}

}  // namespace
}  // namespace wetcurl
