// Strands as other programs hold them: lines, edges, arrays and curves, with all that a file says of a
// strand; and strands written for other programs.
#include <bit>
#include <cmath>

#include "base/exchange/scene_file.h"
#include "base/strands.h"
#include "solver/grooms/chains.h"
#include "solver/grooms/groom.h"
#include "solver/grooms/import.h"
#include "strand_files.h"

namespace wetcurl {
namespace {

using namespace testing;

const std::string cases = WETCURL_SHARED_DIR "/cases/";

// Strands of 2, 3, ... points.
StrandPoints uneven_strands(size_t count = 4) {
    StrandPoints strands = sample_strands(count, count + 1);
    for (size_t s = 0; s < count; ++s) strands[s].resize(s + 2);
    return strands;
}

StrandWidths widths_for(const StrandPoints& strands) {
    StrandWidths widths;
    for (size_t s = 0; s < strands.size(); ++s) {
        auto& of_strand = widths.emplace_back();
        for (size_t i = 0; i < strands[s].size(); ++i)
            of_strand.push_back(float(std::ldexp(1 + double(s) / 8 + double(i) / 64, -14)));
    }
    return widths;
}

// ---- edges

using Edges = std::vector<std::array<size_t, 2>>;
using Chains = std::vector<std::vector<size_t>>;

TEST(Chains, begin_where_edges_lead_away_and_keep_the_order_of_their_lowest_vertex) {
    EXPECT_EQ(chains_of({{0, 1}, {1, 2}, {3, 4}}, 5, "a"), (Chains{{0, 1, 2}, {3, 4}}));
    EXPECT_EQ(chains_of({{2, 1}, {1, 0}}, 3, "a"), (Chains{{2, 1, 0}}));
    EXPECT_EQ(chains_of({{4, 3}, {2, 0}, {1, 2}}, 5, "a"), (Chains{{1, 2, 0}, {4, 3}}));
    // Edges both ways from the middle: the end of lower number.
    EXPECT_EQ(chains_of({{1, 0}, {1, 2}}, 3, "a"), (Chains{{0, 1, 2}}));
    EXPECT_EQ(chains_of({{1, 3}}, 4, "a"), (Chains{{0}, {1, 3}, {2}}));
    EXPECT_EQ(chains_of({}, 2, "a"), (Chains{{0}, {1}}));
}

TEST(Chains, branches_circles_and_edges_to_nowhere_name_the_vertex) {
    expect_error([] { chains_of({{0, 1}, {1, 2}, {1, 3}}, 4, "file"); }, {"file", "vertex 1", "branch"});
    expect_error(
        [] {
            chains_of({{0, 1}, {2, 3}, {3, 4}, {4, 2}}, 5, "file");
        },
        {"file", "vertex 2", "circle"});
    expect_error([] { chains_of({{0, 4}}, 4, "file"); }, {"edge 0", "vertex 4"});
    expect_error([] { chains_of({{3, 3}}, 4, "file"); }, {"edge 0", "vertex 3", "itself"});
    expect_error([] { chains_of({{0, 1}, {1, 0}}, 4, "file"); }, {"edge 1", "twice"});
}

TEST(LineSets, of_open3d_are_strands_by_their_edges) {
    if (!std::filesystem::exists(cases + "ply_lineset_edges")) GTEST_SKIP() << "SKIP: no " << cases;
    const auto even = import_strands(cases + "ply_lineset_edges/lineset_25.ply", {"m", "y"});
    ASSERT_EQ(even.strands.size(), 40u);
    for (const auto& strand : even.strands) EXPECT_EQ(strand.size(), 25u);
    const auto uneven = import_strands(cases + "ply_lineset_edges/lineset_var.ply", {"m", "y"});
    ASSERT_EQ(uneven.strands.size(), 40u);
    EXPECT_EQ(total(uneven.strands), 986u);
    for (const auto& strand : uneven.strands) EXPECT_TRUE(strand.size() >= 20 && strand.size() <= 30);
}

TEST(LineSets, a_mesh_is_no_strands) {
    Scratch scratch;
    const std::string ply = scratch.file(
        "a.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    expect_error([&] { import_strands(ply, {"m", "y"}); }, {ply, "a mesh"});
    const std::string obj = scratch.file("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    expect_error([&] { import_strands(obj, {"m", "y"}); }, {obj, "1 faces", "a mesh, not strands"});
    EXPECT_NO_THROW(import_mesh(obj, {"m", "y"}));
}

TEST(Obj, lines_count_from_1_or_back_and_stand_among_other_things) {
    Scratch scratch;
    const std::string file = scratch.file(
        "a.obj",
        "# hair\r\nmtllib x.mtl\no strands\nv 0 0 0 1.0\nv 0 1 0\nv 0 +2 -0.5\nvt 0 0\nvn 0 0 1\n"
        "l 1/1 2/1 \\\n 3\nf 1 2 3\nv 5 0 0\nv 5 1 0\ng more\nl -2 -1\ns off" +
            std::string(3, '\0'));
    const auto in = import_strands(file, {"m", "y"});
    EXPECT_TRUE(same(in.strands, {{{0, 0, 0}, {0, 1, 0}, {0, 2, -0.5}}, {{5, 0, 0}, {5, 1, 0}}}));
}

TEST(Obj, edges_with_a_line_each_are_joined) {
    Scratch scratch;
    const std::string file = scratch.file("a.obj", "v 0 0 0\nv 0 1 0\nv 0 2 0\nv 9 9 9\nl 1 2\nl 2 3\n");
    EXPECT_TRUE(same(read_obj(file).points, {{{0, 0, 0}, {0, 1, 0}, {0, 2, 0}}}));
    expect_error(
        [&] { read_obj(scratch.file("b.obj", "v 0 0 0\nv 0 1 0\nv 0 2 0\nv 9 9 9\nl 1 2 3\nl 2 4\n")); },
        {"b.obj", "vertex 1", "branch"});
}

// Each edge with two vertices of its own.
TEST(Obj, edges_that_meet_in_equal_points_are_joined_unless_strands_would_branch) {
    Scratch scratch;
    const std::string edges = "v 0 0 0\nv 0 1 0\nv 0 1 0\nv 0 2 0\nl 1 2\nl 3 4\nv 5 0 0\nv 5 1 0\nl 5 6\n";
    EXPECT_TRUE(same(read_obj(scratch.file("a.obj", edges)).points,
                     {{{0, 0, 0}, {0, 1, 0}, {0, 2, 0}}, {{5, 0, 0}, {5, 1, 0}}}));
    const std::string fork = edges + "v 0 1 0\nv 3 1 0\nl 7 8\n";
    EXPECT_EQ(read_obj(scratch.file("b.obj", fork)).points.size(), 4u);
    // Longer lines that begin in one place are strands as they stand.
    const std::string tuft = "v 0 0 0\nv 0 1 0\nv 0 2 0\nv 0 0 0\nv 1 1 0\nv 1 2 0\nl 1 2 3\nl 4 5 6\n";
    EXPECT_EQ(read_obj(scratch.file("c.obj", tuft)).points.size(), 2u);
}

TEST(Obj, a_mark_of_utf8_takes_no_vertex) {
    Scratch scratch;
    EXPECT_TRUE(same(read_obj(scratch.file("a.obj", "\xef\xbb\xbfv 7 0 0\nv 7 1 0\nl 1 2\n")).points,
                     {{{7, 0, 0}, {7, 1, 0}}}));
    const Mesh mesh = read_mesh(scratch.file("m.obj", "\xef\xbb\xbfv 7 0 0\nv 8 0 0\nv 7 1 0\nf 1 2 3\n"), 1);
    EXPECT_EQ(mesh.vertices.size(), 3u);
    EXPECT_EQ(
        read_ply(
            scratch.file(
                "a.ply",
                "\xef\xbb\xbfply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
                "property float z\nelement edge 1\nproperty int vertex1\nproperty int vertex2\nend_header\n"
                "0 0 0\n0 1 0\n0 1\n"))
            .points.size(),
        1u);
}

TEST(Obj, bad_lines_are_named) {
    Scratch scratch;
    for (const auto& [text, line, what] : std::initializer_list<std::tuple<std::string, int, std::string>>{
             {"v 0 0\nl 1 1\n", 1, "coordinates"},
             {"v 0 0 nan\n", 1, "coordinates"},
             {"v 0 0 0\nl 1 2\n", 2, "'2'"},
             {"v 0 0 0\nl 0\n", 2, "counts from 0"},
             {"v 0 0 0\nv 0 1 0\nv 1 1 0\nl 1 2 3 1\n", 4, "closed line"},
             {"v 0 0 0\nl -2\n", 2, "-1 back to -1"},
             {"v 0 0 0\nl x\n", 2, "'x'"}}) {
        const std::string file = scratch.file("a.obj", text);
        expect_error([&] { import_strands(file, {"m", "y"}); }, {file, "line " + std::to_string(line), what});
    }
    expect_error([&] { read_obj(scratch.file("a.obj", "nothing")); }, {"no `l` line"});
}

// ---- .npz

uint32_t crc32_of(const std::string& bytes) {
    uint32_t crc = ~0u;
    for (unsigned char byte : bytes) {
        crc ^= byte;
        for (int k = 0; k < 8; ++k) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
    }
    return ~crc;
}

// As deflate packs bytes that it cannot make fewer: one block, stored.
std::string deflated(const std::string& bytes) {
    return Bytes().put(uint8_t(1)).put(uint16_t(bytes.size())).put(uint16_t(~bytes.size())).text(bytes).str();
}

// A zip archive whose entries are stored as they are, or as deflate would.
std::string zip_file(const std::vector<std::pair<std::string, std::string>>& entries, bool deflate = false) {
    Bytes out, directory;
    auto common = [&](Bytes& to, const std::string& name, const std::string& bytes, size_t packed) {
        to.put(uint16_t(20))
            .put(uint16_t(0))
            .put(uint16_t(deflate ? 8 : 0))
            .put(uint32_t(0))
            .put(crc32_of(bytes));
        to.put(uint32_t(packed)).put(uint32_t(bytes.size())).put(uint16_t(name.size())).put(uint16_t(0));
    };
    for (const auto& [name, bytes] : entries) {
        const uint32_t offset = uint32_t(out.str().size());
        const std::string packed = deflate ? deflated(bytes) : bytes;
        out.text("PK\x03\x04");
        common(out, name, bytes, packed.size());
        out.text(name).text(packed);
        directory.text("PK\x01\x02").put(uint16_t(20));
        common(directory, name, bytes, packed.size());
        directory.put(uint16_t(0)).put(uint16_t(0)).put(uint16_t(0)).put(uint32_t(0)).put(offset).text(name);
    }
    const uint32_t begin = uint32_t(out.str().size());
    out.text(directory.str()).text("PK\x05\x06").put(uint32_t(0));
    out.put(uint16_t(entries.size())).put(uint16_t(entries.size())).put(uint32_t(directory.str().size()));
    out.put(begin).put(uint16_t(0));
    return out.str();
}

// An array of NumPy's, version 1.
std::string npy_file(const std::string& type, bool fortran, const std::string& shape,
                     const std::string& data) {
    std::string header = "{'descr': '" + type + "', 'fortran_order': " + (fortran ? "True" : "False") +
                         ", 'shape': (" + shape + "), }";
    header.resize((header.size() + 10 + 64) / 64 * 64 - 11, ' ');
    header += '\n';
    Bytes out;
    out.text("\x93NUMPY")
        .put(uint8_t(1))
        .put(uint8_t(0))
        .put(uint16_t(header.size()))
        .text(header)
        .text(data);
    return out.str();
}

// Of halves, floats or doubles, the numbers of sample_strands(3, 4).
std::string positions_file(int bytes_each, bool fortran) {
    const StrandPoints strands = sample_strands(3, 4);
    Bytes data;
    auto put = [&](double x) {
        if (bytes_each == 8) data.put(x);
        if (bytes_each == 4) data.put(float(x));
        if (bytes_each != 2) return;
        int exponent = 0;
        const double mantissa = std::frexp(std::abs(x), &exponent);  // x = mantissa 2^exponent, in [0.5, 1)
        const uint16_t bits = x == 0 ? 0 : uint16_t((exponent + 14) << 10 | int((mantissa * 2 - 1) * 1024));
        data.put(uint16_t(bits | (x < 0 ? 0x8000 : 0)));
    };
    auto component = [&](size_t s, size_t i, size_t c) {
        const Vec3d& x = strands[s][i];
        return c == 0 ? x.x : c == 1 ? x.y : x.z;
    };
    for (size_t k = 0; k < 36; ++k)
        put(fortran ? component(k % 3, k / 3 % 4, k / 12) : component(k / 12, k / 3 % 4, k % 3));
    return npy_file("<f" + std::to_string(bytes_each), fortran, "3, 4, 3", data.str());
}

class Npz : public ::testing::Test {
  protected:
    void SetUp() override {
#ifndef WETCURL_HAVE_LIBZIP
        GTEST_SKIP() << "SKIP: built without libzip";
#endif
    }
    Scratch scratch_;
};

TEST_F(Npz, of_any_width_and_order_holds_the_same_strands) {
    for (int bytes : {2, 4, 8})
        for (bool fortran : {false, true})
            for (bool deflate : {false, true}) {
                const std::string file = scratch_.file(
                    "a.npz", zip_file({{"other.npy", "x"}, {"positions.npy", positions_file(bytes, fortran)}},
                                      deflate));
                EXPECT_TRUE(same(read_npz(file).points, sample_strands(3, 4))) << bytes << fortran << deflate;
            }
}

TEST_F(Npz, uv_of_roots_stay_with_their_strands) {
    Bytes uv;
    for (float x : {0.0f, 0.125f, 0.25f, 0.375f, 0.5f, 0.625f}) uv.put(x);
    const std::string file =
        scratch_.file("a.npz", zip_file({{"positions.npy", positions_file(4, false)},
                                         {"root_uv.npy", npy_file("<f4", false, "3, 2", uv.str())}}));
    EXPECT_EQ(import_strands(file, {"m", "y"}).root_uv,
              (std::vector<std::array<float, 2>>{{0, 0.125f}, {0.25f, 0.375f}, {0.5f, 0.625f}}));
}

TEST_F(Npz, what_is_no_array_of_strands_is_refused) {
    auto expect_refused = [&](const std::string& bytes, const std::string& says) {
        const std::string file = scratch_.file("a.npz", bytes);
        expect_error([&] { read_npz(file); }, {file, says});
    };
    auto with = [](const std::string& array) { return zip_file({{"positions.npy", array}}); };
    const std::string data(36 * 4, '\0');
    expect_refused("no archive at all", "zip");
    expect_refused(zip_file({{"vertices.npy", "x"}}), "vertices.npy");
    expect_refused(with("short"), "beginning");
    expect_refused(with(npy_file("<f4", false, "3, 4, 2", data.substr(0, 96))), "3 x 4 x 2");
    expect_refused(with(npy_file("<f4", false, "36", data)), "strands x points x 3");
    expect_refused(with(npy_file("<f4", false, "3, 4, 3", data.substr(4))), "bytes");
    expect_refused(with(npy_file("<f4", false, "9223372036854775807, 4, 3", data)), "more numbers");
    expect_refused(with(npy_file("<f4", false, "99999999999999999999999, 4, 3", data)), "shape");
    expect_refused(with(npy_file("<f4", false, "1000000000, 0, 3", "")), "positions");
    expect_refused(with(npy_file("<f4", false, "0, 4, 3", "")), "one point or more");
    expect_refused(with(npy_file("<i4", false, "3, 4, 3", data)), "<i4");
    expect_refused(with(npy_file("|O", false, "3, 4, 3", data)), "|O");
    expect_refused(with(patched(positions_file(4, false), 128 + 4 * 17, std::nanf(""))), "strand 1, point 1");
    // Damage anywhere: never more than an error.
    const std::string whole = zip_file({{"positions.npy", positions_file(4, false)}});
    Random random(3);
    for (int trial = 0; trial < 300; ++trial) {
        std::string bytes = whole;
        bytes[size_t(random.number(0, double(bytes.size())))] = char(random.number(-128, 128));
        try {
            read_npz(scratch_.file("a.npz", bytes));
        } catch (const Error&) {
        }
    }
}

// ---- curves of scene files

TEST(Curves, of_all_objects_are_joined_with_what_the_file_says_of_them) {
    Scratch scratch;
    const std::string file = scratch.path("a.usda");
    CurvesObject a, b;
    a.path = "/hair/a", b.path = "/hair/b";
    a.counts = {2, 3}, b.counts = {2};
    a.widths = {1, 2, 3, 4, 5}, b.widths = {6, 7};
    a.ids = {10, 11}, b.ids = {12};
    a.groups = {0, 1}, b.groups = {2};
    a.root_uv = {{0, 0}, {0.5f, 0}};  // of b not said: left out
    const auto out =
        create_scene_file(file, false, {.fps = 24, .first_frame = 1, .metres_per_unit = 0.01, .up = 'z'});
    out->add_curves(a);
    out->add_curves(b);
    for (float up : {0.0f, 1.0f}) {
        out->append_curves(0, {{{0, 0, up}, {0, 10, up}, {5, 0, up}, {5, 0, up}, {5, 10, up}}, {}, {}});
        out->append_curves(1, {{{7, 0, up}, {7, 10, up}}, {}, {}});
    }
    out->finish();
    const ImportedStrands in = import_strands(file, {"auto", "auto"});
    EXPECT_EQ(in.units, "cm");
    EXPECT_FALSE(in.guessed);
    ASSERT_EQ(in.strands.size(), 3u);
    EXPECT_LT(norm(in.strands[2][1] - Vec3d{0.07, 0, -0.1}), 1e-9);  // z up in cm
    EXPECT_EQ(in.ids, (std::vector<int>{10, 11, 12}));
    EXPECT_EQ(in.groups, (std::vector<int>{0, 1, 2}));
    EXPECT_TRUE(in.root_uv.empty());
    // A point that repeats the one before goes with its width.
    ASSERT_EQ(in.widths[1].size(), 2u);
    EXPECT_FLOAT_EQ(in.widths[1][0], 0.03f);
    EXPECT_FLOAT_EQ(in.widths[1][1], 0.05f);
}

TEST(Curves, that_the_file_hides_or_marks_as_guides_are_left_out_and_said) {
    Scratch scratch;
    auto curves = [](const std::string& name, double x, const std::string& properties) {
        const std::string at = std::to_string(x);
        return "def BasisCurves \"" + name +
               "\"\n{\nuniform token type = \"linear\"\nint[] curveVertexCounts = [2, 2]\n"
               "point3f[] points = [(" +
               at + ",0,0), (" + at + ",1,0), (" + at + ",0,1), (" + at +
               ",1,1)]\n"
               "int[] primvars:groom_id = [" +
               std::to_string(int(x)) + ", " + std::to_string(int(x) + 1) +
               "] (\ninterpolation = \"uniform\"\n)\n" + properties + "\n}\n";
    };
    const std::string start = "#usda 1.0\n(\nmetersPerUnit = 1\nupAxis = \"Y\"\n)\n",
                      off = "token visibility = \"invisible\"",
                      marks = "int[] primvars:groom_guide = [1, 0] (\ninterpolation = \"uniform\"\n)\n";
    auto ids = [&](const std::string& text, std::string& log) {
        const std::string file = scratch.file("a.usda", start + text);
        ::testing::internal::CaptureStderr();
        const auto in = import_strands(file, {"auto", "auto"});
        log = ::testing::internal::GetCapturedStderr();
        EXPECT_EQ(in.ids.size(), in.strands.size());
        return in.ids;
    };
    std::string log;
    EXPECT_EQ(ids(curves("a", 10, "") + curves("b", 20, off), log), (std::vector<int>{10, 11}));
    EXPECT_NE(log.find("/b (invisible)"), std::string::npos) << log;
    EXPECT_EQ(ids(curves("b", 20, off), log), (std::vector<int>{20, 21}));
    EXPECT_NE(log.find("read nevertheless"), std::string::npos) << log;
    EXPECT_EQ(ids(curves("a", 10, marks) + curves("b", 20, "uniform token purpose = \"guide\""), log),
              (std::vector<int>{11}));
    EXPECT_NE(log.find("1 of 2 strands left out"), std::string::npos) << log;
}

TEST(Curves, binary_usd_names_what_makes_text_of_it_and_text_is_read_whatever_its_ending) {
    Scratch scratch;
    for (const char* name : {"a.usdc", "a.usd", "a.usda"})
        expect_error(
            [&] {
                import_strands(scratch.file(name, "PXR-USDC and more"), {"m", "y"});
            },
            {name, "usdcat"});
    expect_error(
        [&] {
            import_strands(scratch.file("a.usdz", "PK\x03\x04 and more"), {"m", "y"});
        },
        {"a.usdz", "usdcat"});
    const std::string text =
        "#usda 1.0\ndef BasisCurves \"c\"\n{\nuniform token type = \"linear\"\nint[] curveVertexCounts = "
        "[2]\n"
        "point3f[] points = [(0,0,0), (0,1,0)]\n}\n";
    EXPECT_EQ(import_strands(scratch.file("b.usd", text), {"m", "y"}).strands.size(), 1u);
}

TEST(Curves, units_and_axis_that_are_told_hold_against_the_file_with_a_warning) {
    Scratch scratch;
    const std::string file =
        scratch.file("a.usda",
                     "#usda 1.0\n(\nmetersPerUnit = 0.0254\nupAxis = \"Z\"\n)\ndef BasisCurves \"c\"\n{\n"
                     "uniform token type = \"linear\"\nint[] curveVertexCounts = [2]\npoint3f[] points = "
                     "[(0,0,0), (0,0,10)]\n}\n");
    EXPECT_EQ(import_strands(file, {"auto", "auto"}).units, "0.0254 m");
    EXPECT_LT(norm(import_strands(file, {"auto", "auto"}).strands[0][1] - Vec3d{0, 0.254, 0}), 1e-9);
    ::testing::internal::CaptureStderr();
    EXPECT_LT(norm(import_strands(file, {"m", "y"}).strands[0][1] - Vec3d{0, 0, 10}), 1e-9);
    const std::string log = ::testing::internal::GetCapturedStderr();
    EXPECT_NE(log.find("says that z is up"), std::string::npos) << log;
    EXPECT_NE(log.find("says that its unit is 0.0254 m"), std::string::npos) << log;
}

TEST(Curves, cubic_ones_become_points_on_them) {
    Scratch scratch;
    // A parabola y = x^2 / 4, z = 0: every cubic basis has it.
    auto curve = [&](const std::string& basis, const std::string& points, int count) {
        return read_curves(
                   scratch.file("a.usda", "#usda 1.0\ndef BasisCurves \"c\"\n{\nuniform token basis = \"" +
                                              basis + "\"\nint[] curveVertexCounts = [" +
                                              std::to_string(count) + "]\npoint3f[] points = [" + points +
                                              "]\n}\n"))
            .points.at(0);
    };
    // Knots at x = 0, 3 and 6: control points of the blossom.
    const auto bezier =
        curve("bezier", "(0,0,0),(1,0,0),(2,0.75,0),(3,2.25,0),(4,3.75,0),(5,6,0),(6,9,0)", 7);
    EXPECT_EQ(bezier.size(), 9u);
    for (const auto& x : bezier) EXPECT_NEAR(x.y, x.x * x.x / 4, 1e-6);
    EXPECT_EQ(bezier[4].x, 3);
    EXPECT_EQ(bezier[8].x, 6);
    const auto catmull = curve("catmullRom", "(0,0,0),(1,0.25,0),(2,1,0),(3,2.25,0),(4,4,0)", 5);
    EXPECT_EQ(catmull.size(), 9u);
    for (const auto& x : catmull) EXPECT_NEAR(x.y, x.x * x.x / 4, 1e-6);
    EXPECT_EQ(catmull[0].x, 1);
    EXPECT_EQ(catmull[8].x, 3);
    // A uniform B-spline through x^2 has control points x^2 - 1/3.
    const auto b_spline =
        curve("bspline", "(0,-0.08333333,0),(1,0.16666667,0),(2,0.91666667,0),(3,2.16666667,0)", 4);
    EXPECT_EQ(b_spline.size(), 5u);
    for (const auto& x : b_spline) EXPECT_NEAR(x.y, x.x * x.x / 4, 1e-6);
    expect_error([&] { curve("bezier", "(0,0,0),(1,0,0),(2,0,0),(3,0,0),(4,0,0)", 5); },
                 {"/c, strand 0", "5 control points", "4, 7, 10"});
}

TEST(Curves, a_scene_of_meshes_is_no_strands) {
    Scratch scratch;
    const std::string file = scratch.file("a.usda",
                                          "#usda 1.0\ndef Mesh \"m\"\n{\nint[] faceVertexCounts = [3]\n"
                                          "int[] faceVertexIndices = [0,1,2]\npoint3f[] points = "
                                          "[(0,0,0),(1,0,0),(0,1,0)]\n}\n");
    expect_error([&] { import_strands(file, {}); }, {file, "1 meshes and no curves"});
}

// ---- what is kept of each strand

TEST(Import, dropped_strands_are_named_and_the_others_keep_their_numbers) {
    Scratch scratch;
    StrandPoints strands = sample_strands(6);
    strands[0] = {{0, 0, 0}, {1e-7, 0, 0}, {3e-7, 0, 0}};  // shorter than a hair is wide
    strands[3] = {{1, 1, 1}};
    ::testing::internal::CaptureStderr();
    const ImportedStrands in = import_strands(scratch.file("a.data", data_file(strands)), {"m", "y"});
    const std::string log = ::testing::internal::GetCapturedStderr();
    EXPECT_NE(log.find("these are 0, 3"), std::string::npos) << log;
    EXPECT_EQ(in.numbers, (std::vector<size_t>{1, 2, 4, 5}));
    EXPECT_EQ(in.dropped_numbers, (std::vector<size_t>{0, 3}));
    EXPECT_EQ(in.no_length, 1u);
    EXPECT_EQ(in.one_point, 1u);
}

// ---- writing

TEST(Write, strands_and_their_widths_read_back_the_same) {
    Scratch scratch;
    const StrandPoints strands = uneven_strands();
    const StrandWidths widths = widths_for(strands);
    for (const char* name : {"a.hair", "a.data", "a.ply", "a.obj"}) {
        write_strands(scratch.path(name), strands, false, widths);
        const ImportedStrands back = import_strands(scratch.path(name), {"m", "y"});
        EXPECT_TRUE(same(back.strands, strands)) << name;
        const bool holds_widths = std::string(name) == "a.hair" || std::string(name) == "a.ply";
        EXPECT_EQ(back.widths, holds_widths ? widths : StrandWidths{}) << name;
        // Without widths too.
        write_strands(scratch.path(name), strands, true);
        EXPECT_TRUE(same(import_strands(scratch.path(name), {"m", "y"}).strands, strands)) << name;
    }
    expect_error([&] { write_strands(scratch.path("b.ply"), strands, false, {{1}}); },
                 {"b.ply", "1 strands", "4"});
    StrandWidths short_ones = widths;
    short_ones[2].pop_back();
    expect_error([&] { write_strands(scratch.path("b.ply"), strands, false, short_ones); },
                 {"strand 2", "one a point"});
    expect_error(
        [&] {
            write_strands(scratch.path("b.obj"), {{{0, 0, 0}}}, false);
        },
        {"strand 0", "2 or more"});
    EXPECT_FALSE(std::filesystem::exists(scratch.path("b.ply")));
}

TEST(Write, random_floats_of_obj_read_back_to_the_bit) {
    Scratch scratch;
    Random random(4);
    StrandPoints strands(20);
    for (auto& strand : strands)
        for (int i = 0; i < 10; ++i) strand.push_back(cast<double>(cast<float>(random.vector(0.3))));
    write_strands(scratch.path("a.obj"), strands, false);
    const StrandPoints back = read_obj(scratch.path("a.obj")).points;
    ASSERT_EQ(back.size(), strands.size());
    for (size_t s = 0; s < strands.size(); ++s)
        for (size_t i = 0; i < strands[s].size(); ++i) {
            const Vec3f found = cast<float>(back[s][i]), written = cast<float>(strands[s][i]);
            EXPECT_TRUE(found.x == written.x && found.y == written.y && found.z == written.z)
                << s << ", " << i;
        }
}

TEST(Write, tressfx_has_a_power_of_two_points_and_says_when_it_resamples) {
    Scratch scratch;
    const std::string file = scratch.path("a.tfx");
    auto logged = [&](const StrandPoints& strands) {
        ::testing::internal::CaptureStderr();
        write_strands(file, strands, true);
        return ::testing::internal::GetCapturedStderr();
    };
    EXPECT_EQ(logged(sample_strands(5, 8)), "");
    EXPECT_TRUE(same(read_tfx(file).points, sample_strands(5, 8)));
    EXPECT_EQ(read_tfx(file).widths, StrandWidths(5, std::vector<float>(8, 8e-5f)));
    for (const auto& [points, expected] : {std::pair<size_t, size_t>{2, 4}, {5, 8}, {33, 64}, {200, 64}}) {
        const std::string log = logged(sample_strands(3, points));
        EXPECT_NE(log.find("resampled to " + std::to_string(expected)), std::string::npos) << log;
        const StrandPoints back = read_tfx(file).points;
        ASSERT_EQ(back[0].size(), expected);
        EXPECT_LT(norm(back[2].back() - sample_strands(3, points)[2].back()), 1e-6);
    }
    write_strands(file, uneven_strands(), true, widths_for(uneven_strands()));
    const StrandFile back = read_tfx(file);
    ASSERT_EQ(back.points.size(), 4u);
    ASSERT_EQ(back.points[0].size(), 8u);
    EXPECT_EQ(back.widths[3][0], widths_for(uneven_strands())[3].back());  // the largest
}

TEST(Write, pbrt_curves_pass_through_the_points) {
    Scratch scratch;
    const StrandPoints strands = uneven_strands();
    const StrandWidths widths = widths_for(strands);
    write_strands(scratch.path("a.pbrt"), strands, false, widths);
    std::ifstream in(scratch.path("a.pbrt"));
    std::string line;
    std::getline(in, line);
    EXPECT_EQ(line.front(), '#');
    for (size_t s = 0; s < strands.size(); ++s) {
        ASSERT_TRUE(std::getline(in, line));
        EXPECT_TRUE(line.starts_with(
            "Shape \"curve\" \"string type\" \"cylinder\" \"string basis\" \"bezier\" \"point3 P\" ["));
        const size_t open = line.find('['), close = line.find(']');
        std::istringstream numbers(line.substr(open + 1, close - open - 1));
        std::vector<Vec3d> controls;
        for (Vec3d x; numbers >> x.x >> x.y >> x.z;) controls.push_back(x);
        ASSERT_EQ(controls.size(), 3 * (strands[s].size() - 1) + 1);
        for (size_t i = 0; i < strands[s].size(); ++i) EXPECT_EQ(norm(controls[3 * i] - strands[s][i]), 0);
        double width0 = 0, width1 = 0;
        ASSERT_EQ(std::sscanf(line.c_str() + close, "] \"float width0\" %lf \"float width1\" %lf", &width0,
                              &width1),
                  2);
        EXPECT_FLOAT_EQ(float(width0), widths[s].front());
        EXPECT_FLOAT_EQ(float(width1), widths[s].back());
    }
    EXPECT_FALSE(std::getline(in, line));
}

TEST(Write, widths_are_resampled_with_their_strands) {
    const StrandPoints straight{{{0, 0, 0}, {0, 1, 0}, {0, 4, 0}}};
    const StrandWidths widths = resampled_widths(straight, {{0, 1, 4}}, 5);
    EXPECT_EQ(widths, (StrandWidths{{0, 1, 2, 3, 4}}));
    EXPECT_TRUE(resampled_widths(straight, {}, 5).empty());
}

}  // namespace
}  // namespace wetcurl
