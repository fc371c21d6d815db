// USD text: what is written reads back to the bit; what other programs write is read as they mean it; and
// nothing that may stand in a file does more than end in an error.
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <set>
#include <tuple>

#include "base/exchange/usda.h"
#include "base/log.h"
#include "scratch.h"

namespace wetcurl {
namespace {

using namespace testing;

bool same_bits(const std::vector<Vec3f>& a, const std::vector<Vec3f>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(Vec3f)) == 0;
}

std::vector<Vec3f> random_points(Random& random, size_t count) {
    std::vector<Vec3f> points(count);
    // Of any size that a float can have.
    auto number = [&] {
        return float(random.number(0.5, 1) * (random.number() < 0 ? -1 : 1) *
                     std::pow(10, random.number(-44, 30)));
    };
    for (auto& x : points) x = {number(), number(), number()};
    return points;
}

CurvesObject three_strands() {
    CurvesObject curves;
    curves.path = "/hair/strands";
    curves.counts = {2, 4, 3};
    curves.widths = {1e-4f, 2e-5f, 1e-4f, 9e-5f, 8e-5f, 7e-5f, 0, 1, 2};
    curves.ids = {7, -1, 2147483647};
    curves.groups = {0, 0, 1};
    curves.root_uv = {{0, 1}, {0.25f, 0.1f}, {1e-9f, -3}};
    curves.is_guide = {1, 0, 1};
    curves.guides = {{0, 2, 0}, {2, 0, 0}, {2, 0, 0}};
    curves.weights = {{1, 0, 0}, {0.5f, 0.25f, 0.25f}, {1, 0, 0}};
    return curves;
}

MeshObject a_quad() { return {"/head", {}, {4}, {0, 1, 2, 3}, 4, {}}; }

TEST(UsdaWriter, what_is_written_reads_back_to_the_bit) {
    Scratch scratch;
    Random random(1);
    const std::string file = scratch.path("a.usda");
    const SceneFileSettings settings{.fps = 30, .first_frame = 10, .metres_per_unit = 0.01, .up = 'z'};
    const CurvesObject curves = three_strands();
    std::vector<std::vector<Vec3f>> strands, heads;
    {
        const auto out = create_usda(file, false, settings);
        ASSERT_EQ(out->add_curves(curves), 0u);
        ASSERT_EQ(out->add_mesh(a_quad()), 1u);
        for (int frame = 0; frame < 5; ++frame) {
            strands.push_back(random_points(random, 9));
            heads.push_back(random_points(random, 4));
            out->append_curves(0, {strands.back(), random_points(random, 9), std::vector<float>(9, 0.5f)});
            out->append_mesh(1, heads.back());
        }
        EXPECT_FALSE(std::filesystem::exists(file));
        out->finish();
    }
    const auto in = open_usda(file);
    EXPECT_EQ(in->axes().metres_per_unit, 0.01);
    EXPECT_EQ(in->axes().up, 'z');
    ASSERT_EQ(in->curves().size(), 1u);
    const CurvesObject& back = in->curves()[0];
    EXPECT_EQ(back.path, curves.path);
    EXPECT_EQ(back.counts, curves.counts);
    EXPECT_EQ(back.basis, CurveBasis::linear);
    EXPECT_EQ(back.widths, curves.widths);
    EXPECT_EQ(back.ids, curves.ids);
    EXPECT_EQ(back.groups, curves.groups);
    EXPECT_EQ(back.root_uv, curves.root_uv);
    EXPECT_EQ(back.is_guide, curves.is_guide);
    EXPECT_EQ(back.guides, curves.guides);
    EXPECT_EQ(back.weights, curves.weights);
    ASSERT_EQ(back.times.size(), 5u);
    for (size_t k = 0; k < 5; ++k) {
        EXPECT_DOUBLE_EQ(back.times[k], double(10 + k) / 30);
        EXPECT_TRUE(same_bits(in->points_of_curves(0, k), strands[k])) << k;
        EXPECT_TRUE(same_bits(in->points_of_mesh(0, k), heads[k])) << k;
    }
    ASSERT_EQ(in->meshes().size(), 1u);
    EXPECT_EQ(in->meshes()[0].corners, a_quad().corners);
    EXPECT_EQ(in->meshes()[0].counts, a_quad().counts);
}

TEST(UsdaWriter, cubic_curves_keep_their_basis) {
    Scratch scratch;
    for (CurveBasis basis : {CurveBasis::bezier, CurveBasis::b_spline, CurveBasis::catmull_rom}) {
        const std::string file = scratch.path("a.usda");
        CurvesObject curves;
        curves.path = "strands";
        curves.counts = {4};
        curves.basis = basis;
        const auto out = create_usda(file, true, {});
        out->add_curves(curves);
        out->append_curves(0, {std::vector<Vec3f>(4), {}, {}});
        out->finish();
        EXPECT_EQ(open_usda(file)->curves().at(0).basis, basis);
    }
}

TEST(UsdaWriter, what_does_not_move_is_written_once) {
    Scratch scratch;
    const std::string file = scratch.path("a.usda");
    Random random(2);
    const std::vector<Vec3f> still = random_points(random, 4);
    const auto out = create_usda(file, false, {});
    out->add_mesh(a_quad());
    MeshObject other = a_quad();
    other.path = "/late";
    out->add_mesh(other);
    for (int frame = 0; frame < 4; ++frame) {
        out->append_mesh(0, still);
        out->append_mesh(1, frame < 2 ? still : random_points(random, 4));
    }
    out->finish();
    const auto in = open_usda(file);
    EXPECT_EQ(in->meshes()[0].times.size(), 1u);
    EXPECT_EQ(in->meshes()[1].times.size(), 4u);
    EXPECT_TRUE(same_bits(in->points_of_mesh(0, 0), still));
    EXPECT_TRUE(same_bits(in->points_of_mesh(1, 1), still));
    EXPECT_FALSE(same_bits(in->points_of_mesh(1, 2), still));
}

TEST(UsdaWriter, names_become_names_of_usd_and_stay_apart) {
    Scratch scratch;
    const std::string file = scratch.path("a.usda");
    const auto out = create_usda(file, false, {});
    const char* const paths[] = {"/a b/c-d", "/a b/c.d", "/1", "/a b", ""};
    for (const char* path : paths) {
        MeshObject mesh = a_quad();
        mesh.path = path;
        out->add_mesh(mesh);
    }
    for (size_t k = 0; k < std::size(paths); ++k) out->append_mesh(k, std::vector<Vec3f>(4));
    out->finish();
    std::set<std::string> found;
    const auto in = open_usda(file);
    for (const auto& mesh : in->meshes()) found.insert(mesh.path);
    EXPECT_EQ(found, (std::set<std::string>{"/a_b/c_d", "/a_b/c_d_1", "/_1", "/a_b_1", "/mesh"}));
}

TEST(UsdaWriter, misuse_and_bad_frames_are_refused_and_leave_nothing) {
    Scratch scratch;
    const std::string file = scratch.path("a.usda");
    const std::vector<Vec3f> points(9);
    auto with = [&](auto act) {
        return [&, act] {
            const auto out = create_usda(file, false, {});
            act(*out);
        };
    };
    expect_error(with([](SceneWriter& out) { out.finish(); }), {file, "no object"});
    expect_error(with([&](SceneWriter& out) {
                     out.add_curves(three_strands());
                     out.finish();
                 }),
                 {file, "/hair/strands", "0 frames"});
    expect_error(with([&](SceneWriter& out) {
                     out.add_curves(three_strands());
                     out.append_curves(0, {std::vector<Vec3f>(8), {}, {}});
                 }),
                 {file, "frame 1", "8 points", "9"});
    expect_error(with([&](SceneWriter& out) {
                     out.add_curves(three_strands());
                     out.append_curves(0, {points, {}, {}});
                     auto bad = points;
                     bad[8].z = std::numeric_limits<float>::quiet_NaN();
                     out.append_curves(0, {bad, {}, {}});
                 }),
                 {"frame 2", "not finite"});
    expect_error(with([&](SceneWriter& out) {
                     out.add_curves(three_strands());
                     out.append_curves(0, {points, {}, {}});
                     out.append_curves(0, {points, points, {}});
                 }),
                 {"frame 2", "velocities"});
    expect_error(with([&](SceneWriter& out) {
                     out.add_curves(three_strands());
                     out.append_curves(0, {points, {}, {}});
                     out.add_mesh(a_quad());
                 }),
                 {"/head", "after the first frame"});
    expect_error(with([&](SceneWriter& out) {
                     CurvesObject curves = three_strands();
                     curves.counts[1] = 1;
                     out.add_curves(curves);
                 }),
                 {"strand 1", "2 or more"});
    expect_error(with([&](SceneWriter& out) {
                     MeshObject mesh = a_quad();
                     mesh.corners[2] = 4;
                     out.add_mesh(mesh);
                 }),
                 {"/head", "point 4"});
    expect_error<Misuse>([&] { create_usda(file, false, {.up = 'x'}); }, {"'x'", "y, z"});
    expect_error<Misuse>([&] { create_usda(file, false, {.fps = 0}); }, {"frames a second"});
    EXPECT_TRUE(std::filesystem::is_empty(scratch.path()));
}

// ---- reading

const std::string triangle =
    "int[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0, 1, 2]\n"
    "point3f[] points = [(1, 0, 0), (0, 1, 0), (0, 0, 1)]\n";

// A triangle of the unit vectors, in a mesh with these properties, inside of `above`.
std::string usda_of(const std::string& properties, const std::string& above = "",
                    const std::string& layer = "") {
    return "#usda 1.0\n(" + layer + ")\ndef Xform \"a\"\n{\n" + above + "\ndef Mesh \"m\"\n{\n" + triangle +
           properties + "\n}\n}\n";
}

class UsdaReader : public ::testing::Test {
  protected:
    std::unique_ptr<SceneReader> open(const std::string& text) const {
        return open_usda(scratch_.file("a.usda", text));
    }
    // The image of the mesh's point 0, which is (1, 0, 0), 1 or 2.
    Vec3f image(const std::string& properties, int point, const std::string& above = "",
                size_t sample = 0) const {
        return open(usda_of(properties, above))->points_of_mesh(0, sample).at(size_t(point));
    }
    void expect_refused(const std::string& text, std::initializer_list<std::string> parts) const {
        expect_error(
            [&] {
                const auto in = open(text);
                for (size_t k = 0; k < in->curves().size(); ++k)
                    for (size_t s = 0; s < in->curves()[k].times.size(); ++s) in->points_of_curves(k, s);
                for (size_t k = 0; k < in->meshes().size(); ++k)
                    for (size_t s = 0; s < in->meshes()[k].times.size(); ++s) in->points_of_mesh(k, s);
            },
            parts);
    }
    Scratch scratch_;
};

::testing::AssertionResult is_at(const Vec3f& found, float x, float y, float z) {
    if (norm(found - Vec3f{x, y, z}) < 1e-6f * (1 + norm(Vec3f{x, y, z})))
        return ::testing::AssertionSuccess();
    return ::testing::AssertionFailure() << "found " << found.x << ", " << found.y << ", " << found.z;
}

TEST_F(UsdaReader, the_first_transform_of_the_order_is_the_outermost) {
    EXPECT_TRUE(is_at(image("double3 xformOp:translate = (10, 0, 0)\nfloat xformOp:rotateZ = 90\n"
                            "float3 xformOp:scale = (2, 3, 4)\n"
                            "uniform token[] xformOpOrder = [\"xformOp:translate\", \"xformOp:rotateZ\", "
                            "\"xformOp:scale\"]\n",
                            0),
                      10, 2, 0));
}

TEST_F(UsdaReader, angles_are_turned_in_the_order_of_the_name) {
    auto order = [](const std::string& name) {
        return "float3 xformOp:" + name +
               " = (90, 90, 0)\nuniform token[] xformOpOrder = [\"xformOp:" + name + "\"]\n";
    };
    EXPECT_TRUE(is_at(image(order("rotateXYZ"), 2), 0, -1, 0));
    EXPECT_TRUE(is_at(image(order("rotateYXZ"), 2), 1, 0, 0));
    EXPECT_TRUE(is_at(image(order("rotateZYX"), 2), 1, 0, 0));
}

TEST_F(UsdaReader, quaternions_matrices_pivots_and_single_axes) {
    EXPECT_TRUE(is_at(image("quatf xformOp:orient = (0.70710678, 0, 0, 0.70710678)\n"
                            "uniform token[] xformOpOrder = [\"xformOp:orient\"]\n",
                            0),
                      0, 1, 0));
    EXPECT_TRUE(is_at(
        image("matrix4d xformOp:transform = ( (0, 2, 0, 0), (1, 0, 0, 0), (0, 0, 1, 0), (5, 6, 7, 1) )\n"
              "uniform token[] xformOpOrder = [\"xformOp:transform\"]\n",
              0),
        5, 8, 7));
    EXPECT_TRUE(
        is_at(image("double3 xformOp:translate:pivot = (2, 0, 0)\nfloat xformOp:rotateZ = 90\n"
                    "uniform token[] xformOpOrder = [\"xformOp:translate:pivot\", \"xformOp:rotateZ\", "
                    "\"!invert!xformOp:translate:pivot\"]\n",
                    0),
              2, -1, 0));
    EXPECT_TRUE(is_at(
        image("double xformOp:translateY = 4\nuniform token[] xformOpOrder = [\"xformOp:translateY\"]\n", 0),
        1, 4, 0));
}

TEST_F(UsdaReader, transforms_above_apply_unless_the_stack_is_reset) {
    const std::string above =
        "double3 xformOp:translate = (0, 100, 0)\n"
        "uniform token[] xformOpOrder = [\"xformOp:translate\"]\n";
    EXPECT_TRUE(is_at(image("", 0, above), 1, 100, 0));
    EXPECT_TRUE(is_at(image("uniform token[] xformOpOrder = [\"!resetXformStack!\"]\n", 0, above), 1, 0, 0));
    // An order that names what is not there, and one that is not given: nothing applies.
    EXPECT_TRUE(is_at(image("uniform token[] xformOpOrder = [\"xformOp:scale\"]\n", 0), 1, 0, 0));
    EXPECT_TRUE(is_at(image("double3 xformOp:translate = (0, 100, 0)\n", 0), 1, 0, 0));
}

TEST_F(UsdaReader, moving_transforms_have_samples_and_what_lies_between_is_interpolated) {
    const std::string above =
        "double3 xformOp:translate.timeSamples = { 20: (0, 0, 20), 10: (0, 0, 0), }\n"
        "uniform token[] xformOpOrder = [\"xformOp:translate\"]\n";
    const std::string properties =
        "point3f[] points.timeSamples = {\n15: [(0, 0, 0), (1, 0, 0), (0, 0, 0)],\n"
        "25: [(0, 10, 0), (1, 0, 0), (0, 0, 0)] }\n";
    const auto in = open(usda_of(properties, above, "timeCodesPerSecond = 10\nframesPerSecond = 5"));
    EXPECT_EQ(in->meshes()[0].times, (std::vector<double>{1, 1.5, 2, 2.5}));
    const Vec3f expected[] = {{0, 0, 0}, {0, 0, 10}, {0, 5, 20}, {0, 10, 20}};
    for (size_t k = 0; k < 4; ++k) {
        const auto [x, y, z] = expected[k];
        EXPECT_TRUE(is_at(in->points_of_mesh(0, k)[0], x, y, z)) << k;
    }
    // A quarter turn, at half time an eighth.
    const std::string turning =
        "quatf xformOp:orient.timeSamples = { 0: (1, 0, 0, 0), 2: (-0.70710678, 0, 0, -0.70710678) }\n"
        "double xformOp:translateX.timeSamples = { 1: 0 }\n"
        "uniform token[] xformOpOrder = [\"xformOp:orient\", \"xformOp:translateX\"]\n";
    EXPECT_TRUE(is_at(image(turning, 0, "", 1), float(std::sqrt(0.5)), float(std::sqrt(0.5)), 0));
}

TEST_F(UsdaReader, times_count_by_codes_a_second_else_frames_a_second_else_24) {
    const std::string properties = "point3f[] points.timeSamples = { 48: [(0,0,0),(0,0,0),(0,0,0)] }\n";
    auto time = [&](const char* layer) {
        return open(usda_of(properties, "", layer))->meshes()[0].times.at(0);
    };
    EXPECT_EQ(time("timeCodesPerSecond = 12\nframesPerSecond = 48"), 4);
    EXPECT_EQ(time("framesPerSecond = 48"), 1);
    EXPECT_EQ(time(""), 2);
}

TEST_F(UsdaReader, faces_of_left_handed_or_mirrored_meshes_are_turned_round) {
    const std::string mirror =
        "float3 xformOp:scale = (-1, 1, 1)\nuniform token[] xformOpOrder = [\"xformOp:scale\"]\n";
    const std::string left = "uniform token orientation = \"leftHanded\"\n";
    auto corners = [&](const std::string& properties) {
        return open(usda_of(properties))->meshes()[0].corners;
    };
    const std::vector<int> given{0, 1, 2}, turned{0, 2, 1};
    EXPECT_EQ(corners(""), given);
    EXPECT_EQ(corners(left), turned);
    EXPECT_EQ(corners(mirror), turned);
    EXPECT_EQ(corners(mirror + left), given);
}

std::string curves_of(const std::string& properties, const std::string& counts = "[5, 4]") {
    return "#usda 1.0\ndef BasisCurves \"c\"\n{\nint[] curveVertexCounts = " + counts +
           "\npoint3f[] points = "
           "[(0,0,0),(1,0,0),(2,0,0),(3,0,0),(4,0,0),(0,1,0),(1,1,0),(2,1,0),(3,1,0)]\n" +
           properties + "}\n";
}

TEST_F(UsdaReader, curves_are_cubic_bezier_unless_they_say_else) {
    auto basis = [&](const std::string& properties) {
        return open(curves_of(properties))->curves().at(0).basis;
    };
    EXPECT_EQ(basis(""), CurveBasis::bezier);
    EXPECT_EQ(basis("uniform token type = \"linear\"\nuniform token basis = \"bspline\"\n"),
              CurveBasis::linear);
    EXPECT_EQ(basis("uniform token basis = \"bspline\"\n"), CurveBasis::b_spline);
    EXPECT_EQ(basis("uniform token type = \"cubic\"\nuniform token basis = \"catmullRom\"\n"),
              CurveBasis::catmull_rom);
    expect_refused(curves_of("uniform token basis = \"power\"\n"), {"power", "bspline"});
    EXPECT_TRUE(open(curves_of("uniform token wrap = \"periodic\"\n"))->curves().empty());
}

TEST_F(UsdaReader, pinned_curves_begin_and_end_at_their_points) {
    const auto in =
        open(curves_of("uniform token basis = \"catmullRom\"\nuniform token wrap = \"pinned\"\n"
                       "float[] widths = [1, 2, 3, 4, 5, 6, 7, 8, 9]\n"));
    const CurvesObject& curves = in->curves().at(0);
    EXPECT_EQ(curves.counts, (std::vector<int>{7, 6}));
    EXPECT_EQ(curves.widths, (std::vector<float>{1, 1, 2, 3, 4, 5, 5, 6, 6, 7, 8, 9, 9}));
    const auto points = in->points_of_curves(0, 0);
    ASSERT_EQ(points.size(), 13u);
    EXPECT_TRUE(is_at(points[0], -1, 0, 0));
    EXPECT_TRUE(is_at(points[6], 5, 0, 0));
    EXPECT_TRUE(is_at(points[7], -1, 1, 0));
    EXPECT_TRUE(is_at(points[12], 4, 1, 0));
}

TEST_F(UsdaReader, widths_of_any_interpolation_become_one_a_point) {
    const std::string linear = "uniform token type = \"linear\"\n";
    auto widths = [&](const std::string& type, const std::string& values, const std::string& interpolation) {
        return open(
                   curves_of(type + "float[] widths = " + values +
                             (interpolation.empty() ? "" : " ( interpolation = \"" + interpolation + "\" )") +
                             "\n"))
            ->curves()
            .at(0)
            .widths;
    };
    using Widths = std::vector<float>;
    EXPECT_EQ(widths(linear, "[0.5]", "constant"), Widths(9, 0.5f));
    EXPECT_EQ(widths(linear, "[1, 2]", "uniform"), (Widths{1, 1, 1, 1, 1, 2, 2, 2, 2}));
    EXPECT_EQ(widths(linear, "[1,2,3,4,5,6,7,8,9]", "vertex"), (Widths{1, 2, 3, 4, 5, 6, 7, 8, 9}));
    EXPECT_EQ(widths(linear, "[1,2,3,4,5,6,7,8,9]", "varying"), (Widths{1, 2, 3, 4, 5, 6, 7, 8, 9}));
    EXPECT_EQ(widths(linear, "[1,2,3,4,5,6,7,8,9]", ""), (Widths{1, 2, 3, 4, 5, 6, 7, 8, 9}));
    // Splines: one a knot, which is a control point but for the two at the ends.
    EXPECT_EQ(widths("uniform token basis = \"bspline\"\n", "[1,2,3,4,5]", "varying"),
              (Widths{1, 1, 2, 3, 3, 4, 4, 5, 5}));
    // Bezier curves of 4 points have two knots; of 5, which no piece ends, two as well.
    const Widths bezier = widths("", "[0, 3, 6, 9]", "varying");
    ASSERT_EQ(bezier.size(), 9u);
    EXPECT_FLOAT_EQ(bezier[1], 1);
    EXPECT_FLOAT_EQ(bezier[3], 3);
    EXPECT_FLOAT_EQ(bezier[8], 9);
    // Of a number that fits nothing, or below 0: left out, with a warning.
    EXPECT_TRUE(widths(linear, "[1, 2, 3]", "vertex").empty());
    EXPECT_TRUE(widths(linear, "[-1]", "constant").empty());
    EXPECT_TRUE(widths(linear, "[]", "vertex").empty());
}

TEST_F(UsdaReader, ids_and_uv_of_roots_are_found_under_their_usual_names) {
    const auto in =
        open(curves_of("int[] primvars:id = [4, 5] ( interpolation = \"uniform\" )\n"
                       "texCoord2f[] primvars:st = [(0.5, 0.25), (1, 1)] ( interpolation = \"uniform\" )\n"
                       "int[] primvars:st:indices = [1, 0]\nint[] primvars:groom_group_id = [1, 2, 3]\n"));
    const CurvesObject& curves = in->curves().at(0);
    EXPECT_EQ(curves.ids, (std::vector<int>{4, 5}));
    EXPECT_EQ(curves.root_uv, (std::vector<std::array<float, 2>>{{1, 1}, {0.5f, 0.25f}}));
    EXPECT_TRUE(curves.groups.empty());  // three for two strands
}

TEST_F(UsdaReader, all_that_a_text_may_hold_is_passed_over) {
    const auto in = open(R"usda(#usda 1.0
(
    "a layer } with ] brackets ( in texts"
    customLayerData = {
        string x = "}"
        dictionary y = { int[] z = [1, 2] }
    }
    doc = """of three
lines: "quoted" } """
    upAxis = "Y"; metersPerUnit = 1
)
# a comment } with brackets
// another {
/* and
   a long one { */

over "nothing" { def Mesh "n" {} }
class "c" { float x = 1 }
def "plain" ( active = false ) { def BasisCurves "off" { int[] curveVertexCounts = [1, "x"] } }
def Scope "s" (
    prepend apiSchemas = ["A", "B"]
    kind = 'component'
    variants = { string v = "x" }
)
{
    reorder nameChildren = ["b", "a"]
    custom string text = 'it\'s'
    custom asset file = @./with [brackets} and spaces.png@
    asset other = @@@with @ in it@@@
    asset[] more = [@a@, @b@]
    rel target = </a/b.c[/d]>
    prepend rel targets = [ </a>, </b> ] ( customData = { int x = 1 } )
    rel nothing
    float in.connect = </x.y>
    custom double spline.spline = { bezier, 1: 2.5; post held, (0.1, 2), }
    float[] animated.timeSamples = { 1: None, 2: [1, 2, # with a comment ]
        3], }
    token outputs:surface.connect = None
    timecode at = 3
    string[] words = ["]", '"', """ ] """]
    uniform token purpose = "render"; bool flag = true
    dictionary d = { "a b": 1 }
    variantSet "v" = {
        "x" ( doc = "}" ) { def Mesh "inner" { } }
        "y" { }
    }
    def BasisCurves "c" (
        kind = "x"
    )
    {
        int[] curveVertexCounts = [2, ]
        point3f[] points = None
        point3f[] points.timeSamples = {
            1: None,
            2: [(0, 0, 0), (+1, .5, -1e-3),],
            3: [(0, 0, 0), (1, 2., 1E2)],
        }
        uniform token type = "linear"
        float[] widths (interpolation = "constant")
        float[] widths = [0.5]
    }
}
)usda");
    ASSERT_EQ(in->curves().size(), 1u);
    EXPECT_EQ(in->curves()[0].path, "/s/c");
    EXPECT_EQ(in->curves()[0].times.size(), 2u);
    EXPECT_EQ(in->curves()[0].widths, (std::vector<float>{0.5f, 0.5f}));
    EXPECT_TRUE(is_at(in->points_of_curves(0, 0)[1], 1, 0.5f, -1e-3f));
    EXPECT_TRUE(is_at(in->points_of_curves(0, 1)[1], 1, 2, 100));
    EXPECT_TRUE(in->meshes().empty());
}

TEST_F(UsdaReader, marks_what_the_file_hides) {
    auto mesh = [](const std::string& name, const std::string& properties) {
        return "def Mesh \"" + name +
               "\" {\nint[] faceVertexCounts = [3]\nint[] faceVertexIndices = [0, 1, 2]\n"
               "point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\n" +
               properties + "\n}\n";
    };
    auto group = [](const std::string& name, const std::string& properties, const std::string& below) {
        return "def Xform \"" + name + "\" {\n" + below + properties + "\n}\n";
    };
    const auto in =
        open("#usda 1.0\n" + mesh("plain", "") + mesh("off", "token visibility = \"invisible\"") +
             mesh("later", "token visibility.timeSamples = { 1: \"invisible\", 5: \"inherited\" }") +
             mesh("never", "token visibility.timeSamples = { 1: \"invisible\", 5: \"invisible\" }") +
             mesh("proxy", "uniform token purpose = \"proxy\"") +
             group("off_group", "token visibility = \"invisible\"",
                   mesh("below", "token visibility = \"inherited\"")) +
             group("guides", "uniform token purpose = \"guide\"",
                   mesh("below", "") + mesh("render", "uniform token purpose = \"render\"")));
    std::map<std::string, std::string> hidden;
    for (const auto& object : in->meshes()) hidden[object.path] = object.hidden;
    EXPECT_EQ(hidden, (std::map<std::string, std::string>{{"/plain", ""},
                                                          {"/off", "invisible"},
                                                          {"/later", ""},
                                                          {"/never", "invisible"},
                                                          {"/proxy", "for proxy"},
                                                          {"/off_group/below", "invisible"},
                                                          {"/guides/below", "for guide"},
                                                          {"/guides/render", ""}}));
    const auto chosen = [&](const std::string& object) {
        std::set<std::string> paths;
        for (size_t k : chosen_objects("a.usda", in->meshes(), object, "meshes"))
            paths.insert(in->meshes()[k].path);
        return paths;
    };
    EXPECT_EQ(chosen(""), (std::set<std::string>{"/plain", "/later", "/guides/render"}));
    EXPECT_EQ(chosen("/off"), (std::set<std::string>{"/off"}));
    EXPECT_EQ(chosen("/guides"), (std::set<std::string>{"/guides/render"}));
    EXPECT_EQ(chosen("/off_group"), (std::set<std::string>{"/off_group/below"}));
    EXPECT_TRUE(chosen("/none").empty());
}

TEST_F(UsdaReader, files_whose_geometry_lies_elsewhere_say_how_to_flatten_them) {
    for (const std::string& text : std::initializer_list<std::string>{
             "(\nsubLayers = [@./other.usda@ (offset = 1; scale = 2)]\n)\n",
             "\n\ndef \"a\" ( references = @other.usda@</x> (offset = 10) ) {}\n",
             "\n\ndef \"a\" ( prepend payload = [@other.usda@, @b.usda@] ) {}\n",
             "\n\ndef \"a\" { variantSet \"v\" = { \"x\" { def Mesh \"m\" {} } } }\n"})
        expect_refused("#usda 1.0\n" + text, {"neither curves nor a mesh", "(line", "`usdcat --flatten"});
    // With geometry of its own a file is read.
    EXPECT_EQ(open(usda_of("", "", "subLayers = [@a.usda@]"))->meshes().size(), 1u);
}

TEST_F(UsdaReader, other_kinds_of_files_are_named) {
    expect_refused("PXR-USDC and bytes", {"binary USD", "`usdcat ", ".usda` turns it into text"});
    expect_refused("PK\x03\x04 and bytes", {".usdz", "`usdcat "});
    expect_refused("version https://git-lfs.github.com/spec/v1\n", {"git lfs pull"});
    expect_refused("solid\n", {"no USD text"});
    expect_refused("", {"empty"});
    expect_error([&] { open_usda(scratch_.path("missing.usda")); }, {"missing.usda", "no such file"});
    expect_error([&] { open_usda(scratch_.path()); }, {"no plain file"});
    EXPECT_EQ(open("\xef\xbb\xbf#usda 1.0\n")->curves().size(), 0u);
}

TEST_F(UsdaReader, errors_name_file_and_line) {
    const std::string file = scratch_.path("a.usda");
    for (const auto& [text, line, what] : std::initializer_list<std::tuple<std::string, int, std::string>>{
             {"#usda 1.0\ndef Mesh m {}\n", 2, "the name of a prim"},
             {"#usda 1.0\ndef Mesh \"m\" {\nint x = \n}\n", 4, "a value"},
             {"#usda 1.0\ndef Mesh \"m\" {\nint x = [1, (2]\n}\n", 3, "')'"},
             {"#usda 1.0\ndef Mesh \"m\" {\nint x = [1, 2\n", 4, "the end of the file"},
             {"#usda 1.0\ndef Mesh \"m\" {\nstring x = \"a\n\"\n}\n", 3, "quotes"},
             {"#usda 1.0\ndef Mesh \"m\" {\nstring x = \"\"\"a\n", 4, "begins in line 3"},
             {"#usda 1.0\n(\nmetersPerUnit = 0\n)\n", 3, "above 0"},
             {"#usda 1.0\n(\nupAxis = \"W\"\n)\n", 3, "'W'"},
             {"#usda 1.0\nwhat is this\n", 2, "'what'"},
             {curves_of("", "[5, 4, x]"), 4, "a whole number"},
             {curves_of("", "[5, 4.5]"), 4, "','"},
             {curves_of("float[] widths = [1e99]\n"), 6, "finite"},
             {curves_of("int[] primvars:id = [1, 3000000000]\n"), 6, "whole number"},
             {usda_of("point3f[] points.timeSamples = {\n1: [(0,0,0),(1,1,1),(2,2,2)],\n2: [(0, 0)] }"), 13,
              "','"},
             {usda_of("point3f[] points.timeSamples = {\n1: [(0,0,0),(1,1,1),(2,2,2)],\n2: [(0, 0, 0)] }"),
              13, "1 points"},
             {usda_of("point3f[] points.timeSamples = {\n1: [(0,0,0),(1,1,1),(2,2,2)],\n2: [(0,0,0),\n(nan, "
                      "0, 0),(0,0,0)] }"),
              14, "a finite number"},
             {usda_of("float3 xformOp:rotateXXY = (1,2,3)\nuniform token[] xformOpOrder = "
                      "[\"xformOp:rotateXXY\"]"),
              11, "rotateXYZ"},
             {usda_of("float3 xformOp:scale = (1,2)\nuniform token[] xformOpOrder = [\"xformOp:scale\"]"), 11,
              "2 numbers"},
             {usda_of("float3 xformOp:scale = (1,2,0)\nuniform token[] xformOpOrder = "
                      "[\"!invert!xformOp:scale\"]"),
              11, "inverse"}})
        expect_refused(text, {file + ":" + std::to_string(line) + ":", what});
    expect_refused(curves_of("", "[5, 5]"), {file + ":5: /c", "9 points", "10"});
    expect_refused(curves_of("", "[2147483647, 2147483647, 11]"), {file, "/c", "9 points"});
    expect_refused(curves_of("", "[10, -1]"), {file + ":4: /c", "strand 1", "-1"});
    expect_refused(usda_of("int[] faceVertexIndices = [0, 1, 3]"), {"/a/m", "point 3"});
    expect_refused(
        usda_of(
            "int[] faceVertexIndices.timeSamples = { 1: [0, 1, 2], 2: [2, 1, 0] }\n"
            "point3f[] points.timeSamples = { 1: [(0,0,0),(1,1,1),(2,2,2)], 2: [(0,0,0),(1,1,1),(2,2,3)] }"),
        {"/a/m", "sample 1", "joined in another way"});
}

TEST_F(UsdaReader, nesting_has_a_limit) {
    std::string prims = "#usda 1.0\n", brackets = "#usda 1.0\ndef \"a\" { int x = ";
    for (int k = 0; k < 100000; ++k) prims += "def \"a\" {\n", brackets += "(";
    expect_refused(prims, {"200 prims"});
    expect_refused(brackets, {"200 brackets"});
    expect_refused("#usda 1.0\ndef \"" + std::string(100000, 'a') + "\" {}\n", {"4096"});
}

TEST_F(UsdaReader, random_damage_never_does_more_than_end_in_an_error) {
    Random random(5);
    const std::string whole =
        usda_of(
            "uniform token orientation = \"leftHanded\"\n"
            "point3f[] points.timeSamples = { 1: [(0,0,0),(1,1,1),(2,2,2)], 3: [(0,0,0),(1,1,1),(2,2,3)] }\n",
            "quatf xformOp:orient.timeSamples = { 0: (1, 0, 0, 0), 2: (0.6, 0, 0, 0.8) }\n"
            "matrix4d xformOp:transform = ( (0, 2, 0, 0), (1, 0, 0, 0), (0, 0, 1, 0), (5, 6, 7, 1) )\n"
            "uniform token[] xformOpOrder = [\"xformOp:orient\", \"!invert!xformOp:transform\"]\n",
            "metersPerUnit = 0.01\nsubLayers = [@a@ (offset = 1)]\n") +
        curves_of(
            "float[] widths = [1, 2] ( interpolation = \"uniform\" )\nuniform token basis = \"catmullRom\"\n"
            "uniform token wrap = \"pinned\"\nint[] primvars:groom_id = [1, 2]\n"
            "variantSet \"v\" = { \"x\" { } }\nrel y = </a/b>\nstring s = \"\"\"text\"\"\"\n")
            .substr(std::string("#usda 1.0\n").size());
    ASSERT_EQ(open(whole)->curves().size() + open(whole)->meshes().size(), 2u);
    constexpr std::string_view special = "()[]{}\"'@<>#/*=:,;\\\n.-+eN019 \0\xff";
    set_log_level(LogLevel::error);  // the warnings are meant
    int refusals = 0;
    constexpr int trials = 1500;
    for (int trial = 0; trial < trials; ++trial) {
        std::string text = whole;
        auto place = [&] { return size_t(random.number(0, double(text.size()))); };
        for (int k = 0; k <= trial % 3; ++k) {
            const size_t at = place();
            const size_t count = std::min(size_t(random.number(0, 40)), text.size() - at);
            switch (trial / 3 % 4) {
                case 0:
                    text[at] = special[size_t(random.number(0, double(special.size())))];
                    break;
                case 1:
                    text.erase(at, count);
                    break;
                case 2:
                    text.insert(place(), text.substr(at, count));
                    break;
                default:
                    text.resize(at);
            }
            if (text.empty()) break;
        }
        try {
            const auto in = open(text);
            for (size_t o = 0; o < in->curves().size(); ++o) {
                const auto& curves = in->curves()[o];
                ASSERT_TRUE(curves.widths.empty() || curves.widths.size() == curves.points());
                for (size_t s = 0; s < curves.times.size(); ++s)
                    ASSERT_EQ(in->points_of_curves(o, s).size(), curves.points());
            }
            for (size_t o = 0; o < in->meshes().size(); ++o)
                for (size_t s = 0; s < in->meshes()[o].times.size(); ++s)
                    for (const auto& x : in->points_of_mesh(o, s))
                        ASSERT_TRUE(std::isfinite(x.x + x.y + x.z));
        } catch (const Error& e) {
            ASSERT_NE(std::string(e.what()).find(scratch_.path()), std::string::npos) << e.what();
            ++refusals;
        }
    }
    set_log_level(LogLevel::info);
    EXPECT_GT(refusals, trials / 4);
    EXPECT_LT(refusals, trials);
}

}  // namespace
}  // namespace wetcurl
