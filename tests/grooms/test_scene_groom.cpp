// `[groom]` of a scene: files laid on a grid, thinning, roots under the scalp; the import command.
#include <nlohmann/json.hpp>
#include <set>

#include "app/commands/import.h"
#include "base/geometry/shapes.h"
#include "solver/grooms/groom.h"
#include "solver/grooms/procedural.h"
#include "strand_files.h"

namespace wetcurl {
namespace {

using namespace testing;

Groom load(const std::string& toml, const std::string& folder = ".", const std::string& file = "") {
    Config config = Config::parse("[groom]\n" + toml, "scene.toml", folder);
    if (!file.empty()) config.set("groom.file='" + file + "'", "--groom");
    const Groom g = load_groom(config.root().table("groom"), 1);
    config.require_all_used();
    return g;
}

// Strands on a dome of 0.1 m, 0.2 m long, straight along its normals, `points` each; the last `bald` are
// degenerate.
StrandPoints hedgehog(int count, int points, int bald = 0) {
    Random random(9);
    StrandPoints out;
    while (int(out.size()) < count) {
        const Vec3d d = random.direction();
        if (d.y < 0.1) continue;
        std::vector<Vec3d> strand;
        for (int i = 0; i < points; ++i) strand.push_back((0.1 + 0.2 * i / (points - 1)) * d);
        out.push_back(strand);
    }
    for (int i = 0; i < bald; ++i) out.push_back({{0, 0.1, 0}});
    return out;
}

std::string ball_file(const Scratch& scratch, double radius) {
    const Mesh mesh = triangulated(Sphere{radius}, 48);
    std::ostringstream out;
    for (const auto& x : mesh.vertices)
        out << "v " << 100 * x.x << ' ' << 100 * x.y << ' ' << 100 * x.z << '\n';
    for (const auto& t : mesh.triangles)
        out << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
    return scratch.file("ball.obj", out.str());
}

TEST(SceneGroom, without_a_file_it_is_the_built_in_one) {
    const Groom g = load("grid = [8, 4]\nparticles = 20\n");
    EXPECT_EQ(g.rest.count, 32);
    EXPECT_EQ(g.rest.particles, 20);
    ProceduralGroom p = read_procedural(Config::parse("grid = [8, 4]\nparticles = 20\n", "a").root(), 1);
    EXPECT_EQ(g.hash(), make_procedural(p).hash());
}

TEST(SceneGroom, strands_of_a_file_are_resampled_and_lie_in_the_order_of_their_pixels) {
    Scratch scratch;
    scratch.file("hair.data", data_file(hedgehog(300, 11, 5)));
    const Groom g = load("file = 'hair.data'\nunits = 'm'\nparticles = 30\n", scratch.path());
    EXPECT_EQ(g.rest.particles, 30);
    EXPECT_EQ(g.rest.count, 300);
    int pixel = 0;
    for (int s = 0; s < g.rest.count; ++s, ++pixel) {
        while (g.grid.strand[size_t(pixel)] < 0) ++pixel;
        ASSERT_EQ(g.grid.strand[size_t(pixel)], s);
        const Vec3d root = cast<double>(g.rest.at(s, 0)), tip = cast<double>(g.rest.at(s, 29));
        ASSERT_NEAR(norm(root), 0.1, 1e-6);
        ASSERT_NEAR(norm(tip), 0.3, 1e-6);
        ASSERT_NEAR(norm(cast<double>(g.rest.at(s, 13) - g.rest.at(s, 12))), 0.2 / 29, 1e-5);
        // Off the middle of the dome that roots stand on.
        ASSERT_GT(dot(cast<double>(g.normal[size_t(s)]), root), 0.0999);
    }
}

// Strands that a file has are strands of the scene, whatever their count, and keep their numbers.
TEST(SceneGroom, no_strand_of_a_file_is_lost) {
    for (int count : {1, 2, 3, 5, 7, 101, 1000}) {
        Scratch scratch;
        const StrandPoints strands = hedgehog(count, 5);
        scratch.file("hair.data", data_file(strands));
        const Groom g = load("file = 'hair.data'\nunits = 'm'\nparticles = 4\n", scratch.path());
        ASSERT_EQ(g.rest.count, count);
        std::set<int> numbers;
        for (int s = 0; s < count; ++s) {
            const int number = g.origin[size_t(s)].number;
            EXPECT_TRUE(numbers.insert(number).second);
            EXPECT_LT(norm(cast<double>(g.rest.at(s, 0)) - strands[size_t(number)][0]), 1e-6);
        }
        // What a coarser grid has keeps its number too.
        std::vector<int> kept;
        const Groom coarse = coarsened(g, 2, &kept);
        for (size_t s = 0; s < kept.size(); ++s)
            EXPECT_EQ(coarse.origin[s].number, g.origin[size_t(kept[s])].number);
    }
}

TEST(SceneGroom, units_axis_scale_and_offset_reach_the_strands) {
    Scratch scratch;
    scratch.file("hair.data", data_file(hedgehog(64, 5)));
    const Groom usual = load("file = 'hair.data'\nunits = 'm'\n", scratch.path());
    const Groom moved =
        load("file = 'hair.data'\nunits = 'm'\nscale = 2\noffset = [0, 1, 0]\n", scratch.path());
    const Groom small = load("file = 'hair.data'\nunits = 'cm'\n", scratch.path());
    const Groom turned = load("file = 'hair.data'\nunits = 'm'\nup = 'z'\n", scratch.path());
    const Vec3f usual_tip = usual.rest.at(0, 49);
    auto nearest = [](const Groom& g, const Vec3f& x) {
        float best = 1;
        for (int s = 0; s < g.rest.count; ++s) best = std::min(best, norm(g.rest.at(s, 49) - x));
        return best;
    };
    EXPECT_LT(nearest(moved, 2.0f * usual_tip + Vec3f{0, 1, 0}), 1e-6f);
    EXPECT_LT(nearest(small, 0.01f * usual_tip), 1e-6f);
    EXPECT_LT(nearest(turned, {usual_tip.x, usual_tip.z, -usual_tip.y}), 1e-6f);
}

TEST(SceneGroom, a_grid_may_be_asked_for_and_is_the_finest_where_it_cannot_be_filled) {
    Scratch scratch;
    scratch.file("hair.data", data_file(hedgehog(300, 5)));
    EXPECT_EQ(load("file = 'hair.data'\nunits = 'm'\ngrid = [12, 8]\n", scratch.path()).rest.count, 96);
    ::testing::internal::CaptureStderr();
    const Groom g = load("file = 'hair.data'\nunits = 'm'\ngrid = [32, 32]\n", scratch.path());
    const std::string log = ::testing::internal::GetCapturedStderr();
    EXPECT_GE(g.rest.count, 270);
    EXPECT_NE(log.find("32 x 32"), std::string::npos) << log;
    EXPECT_NE(log.find("scene.toml:4"), std::string::npos) << log;
}

TEST(SceneGroom, a_scalp_gives_the_normals) {
    Scratch scratch;
    ball_file(scratch, 0.105);
    StrandPoints strands = hedgehog(200, 5);
    for (auto& strand : strands)
        for (auto& x : strand) x += Vec3d{0, 0, 0.004};  // the roots' own middle is off the ball's
    scratch.file("hair.data", data_file(strands));
    const Groom g =
        load("file = 'hair.data'\nunits = 'm'\nscalp = 'ball.obj'\nscalp_units = 'cm'\n", scratch.path());
    for (int s = 0; s < g.rest.count; ++s)
        ASSERT_GT(
            dot(cast<double>(g.normal[size_t(s)]), normalized(cast<double>(g.rest.at(s, 0)), Vec3d{0, 1, 0})),
            0.998);
}

TEST(SceneGroom, a_file_laid_over_a_built_in_groom_leaves_its_keys_to_rest) {
    Scratch scratch;
    const std::string file = scratch.file("hair.data", data_file(hedgehog(100, 5)));
    const Groom g = load("curl_radius = 0.01\npitch = 0.03\nunits = 'm'\n", ".", file);
    EXPECT_EQ(g.rest.count, 100);
    expect_error<Misuse>([&] { load("curl_radius = -1\nunits = 'm'\n", ".", file); },
                         {"scene.toml:2", "curl_radius"});
    expect_error<Misuse>([&] { load("curl_radios = 1\nunits = 'm'\n", ".", file); },
                         {"scene.toml:2", "curl_radios", "curl_radius"});
}

TEST(SceneGroom, wrong_keys_and_files_are_named) {
    Scratch scratch;
    scratch.file("hair.data", data_file(hedgehog(64, 5)));
    const std::string file = "file = 'hair.data'\n";
    auto refused = [&](const std::string& line, std::initializer_list<std::string> says) {
        expect_error<Misuse>([&] { load(file + line, scratch.path()); }, says);
    };
    refused("units = 'inch'\n", {"scene.toml:3", "units", "inch"});
    refused("up = 'w'\n", {"scene.toml:3", "up"});
    refused("particles = 1\n", {"scene.toml:3", "particles"});
    refused("scale = 0\n", {"scene.toml:3", "scale"});
    refused("offset = [0, 1]\n", {"scene.toml:3", "offset"});
    refused("scalp_units = 'cm'\n", {"scene.toml:3", "scalp_units"});  // of no scalp
    expect_error<Misuse>([&] { load("file = 'none.data'\n", scratch.path()); },
                         {"scene.toml:2", "file", "none.data", "no file"});
    expect_error([&] { load("file = 'hair.data'\nscalp = 'none.obj'\n", scratch.path()); }, {"none.obj"});
}

TEST(Thinned, takes_the_finest_stride_within_the_limit) {
    const Groom full = load("grid = [32, 16]\nparticles = 5\n");
    for (const auto& [limit, strands, expected] : {std::tuple{100000, 512, 1},
                                                   {512, 512, 1},
                                                   {511, 128, 2},
                                                   {128, 128, 2},
                                                   {40, 32, 4},
                                                   {7, 2, 16},
                                                   {1, 1, 32}}) {
        int stride = 0;
        const Groom thin = thinned(full, limit, &stride);
        EXPECT_EQ(thin.rest.count, strands);
        EXPECT_EQ(stride, expected);
        EXPECT_EQ(thin.hash(), coarsened(full, stride).hash());
    }
    expect_error<Misuse>([&] { thinned(full, 0); }, {"--strands", "1 or more"});
    EXPECT_EQ(nesting_text(full), "this groom nests as 1, 2, 8, 32, 128, 512 strands");
    Groom holed = full;
    holed.grid.strand[0] = -1;
    EXPECT_EQ(nesting_text(holed), "this groom nests as 1, 7, 31, 127, 511 strands");
}

TEST(SceneGroom, keeps_the_widths_of_its_file_along_each_strand) {
    Scratch scratch;
    const StrandPoints strands = hedgehog(40, 7);
    StrandWidths widths;
    for (size_t s = 0; s < strands.size(); ++s) {
        auto& along = widths.emplace_back();
        for (int i = 0; i < 7; ++i) along.push_back(1e-4f - 1e-5f * float(i) + 1e-6f * float(s));
    }
    write_strands(scratch.path("hair.ply"), strands, false, widths);
    const Groom g = load("file = \"" + scratch.path("hair.ply") + "\"\nunits = \"m\"\nparticles = 13\n");
    ASSERT_EQ(g.width.size(), g.rest.points.size());
    for (int s = 0; s < g.rest.count; ++s)
        for (int i = 0; i < 13; ++i) {
            const float root = 1e-4f + 1e-6f * float(g.origin[size_t(s)].number);
            EXPECT_NEAR(g.width[size_t(13 * s + i)], root - 0.5e-5f * float(i), 1e-9f) << s << " " << i;
        }
    // Of a thinned groom, those of the strands that are left.
    const Groom few = coarsened(g, 2);
    ASSERT_EQ(few.width.size(), few.rest.points.size());
    for (int s = 0; s < few.rest.count; ++s)
        EXPECT_NEAR(few.width[size_t(13 * s)], 1e-4f + 1e-6f * float(few.origin[size_t(s)].number), 1e-9f);
}

TEST(RootDepth, counts_roots_under_the_scalp_and_how_deep) {
    Scratch scratch;
    const ScalpMesh scalp(import_mesh(ball_file(scratch, 0.105), {"cm", "y"}));
    StrandPoints strands = hedgehog(90, 3);
    for (size_t s = 0; s < 30; ++s)
        for (auto& x : strands[s]) x = 1.2 * x;
    const RootDepth depth = root_depth(strands, scalp);
    EXPECT_EQ(depth.roots, 90);
    EXPECT_EQ(depth.below, 60);
    EXPECT_NEAR(depth.median, 0.005, 3e-4);
    EXPECT_NEAR(depth.deepest, 0.005, 3e-4);
}

TEST(RootDepth, is_the_same_on_a_scalp_of_a_scene_file) {
    Scratch scratch;
    const std::string obj = ball_file(scratch, 0.105);
    const Mesh ball = read_mesh(obj, 1);
    MeshObject object;
    object.path = "/head";
    object.points = ball.vertices.size();
    for (const auto& t : ball.triangles) {
        object.counts.push_back(3);
        object.corners.insert(object.corners.end(), t.begin(), t.end());
    }
    std::vector<Vec3f> later = ball.vertices;
    for (Vec3f& x : later) x.y += 100;
    const RootDepth wanted = root_depth(hedgehog(90, 3), ScalpMesh(import_mesh(obj, {"cm", "y"})));
    for (const char* name : {"head.abc", "head.usda"}) {
        const std::string path = scratch.path(name);
        const auto file = create_scene_file(path, false, SceneFileSettings{.metres_per_unit = 0.01});
        file->add_mesh(object);
        file->append_mesh(0, ball.vertices), file->append_mesh(0, later);
        file->finish();
        const RootDepth found = root_depth(hedgehog(90, 3), ScalpMesh(import_mesh(path, {"cm", "auto"})));
        EXPECT_EQ(found.below, wanted.below) << name;
        EXPECT_NEAR(found.median, wanted.median, 1e-6) << name;
        EXPECT_NEAR(found.away, wanted.away, 1e-6) << name;
    }
}

TEST(RootDepth, warns_where_hair_and_scalp_cannot_belong_together) {
    Scratch scratch;
    const ScalpMesh in_millimetres(import_mesh(ball_file(scratch, 0.105), {"mm", "y"}));
    ::testing::internal::CaptureStderr();
    const RootDepth depth = root_depth(hedgehog(20, 3), in_millimetres);
    EXPECT_NE(::testing::internal::GetCapturedStderr().find("units"), std::string::npos);
    EXPECT_NEAR(depth.away, 0.1 - 0.0105, 1e-3);
}

// ---- the command

TEST(ImportCommand, reports_and_converts) {
    Scratch scratch;
    ImportOptions o;
    StrandPoints strands = hedgehog(300, 11, 5);
    for (auto& strand : strands)
        for (auto& x : strand) x = 100.0 * x;
    o.input = scratch.file("hair.data", data_file(strands));
    o.output = scratch.path("out.hair");
    o.scalp = ball_file(scratch, 0.105);
    o.groom.units = "cm";
    o.resample = 16;
    o.json = scratch.path("report.json");
    ::testing::internal::CaptureStdout();
    EXPECT_EQ(import_command(o), 0);
    const std::string text = ::testing::internal::GetCapturedStdout();
    EXPECT_NE(text.find("dropped   5 of 305"), std::string::npos) << text;

    const auto json = nlohmann::json::parse(bytes_of(o.json));
    EXPECT_EQ(json["strands"], 300);
    EXPECT_EQ(json["points"], 4800);
    EXPECT_EQ(json["strands_in_file"], 305);
    EXPECT_EQ(json["dropped"]["one_point"], 5);
    EXPECT_EQ(json["units"], "cm");
    EXPECT_EQ(json["units_guessed"], false);
    EXPECT_NEAR(json["median_length"].get<double>(), 0.2, 1e-5);
    EXPECT_NEAR(json["bounds"]["high"][1].get<double>(), 0.3, 0.01);
    EXPECT_EQ(json["below_scalp"]["roots"], 300);
    EXPECT_EQ(json["grid"]["roots_left_out"], 0);

    const StrandPoints back = import_strands(o.output, {"m", "y"}).strands;
    ASSERT_EQ(back.size(), 300u);
    EXPECT_EQ(back[0].size(), 16u);
    EXPECT_NEAR(norm(back[7][15]), 0.3, 1e-6);
    expect_error([&] { import_command(o); }, {"out.hair", "--overwrite"});
    o.overwrite = true, o.output = o.input;
    expect_error<Misuse>([&] { import_command(o); }, {"destroy the input"});
}

TEST(Import, a_stray_point_changes_no_unit) {
    Scratch scratch;
    StrandPoints strands = hedgehog(300, 11);
    strands[17].back() = {0, 400, 0};
    EXPECT_EQ(import_strands(scratch.file("hair.data", data_file(strands)), {}).units, "m");
}

TEST(ImportCommand, turns_moves_and_repairs_strands_as_a_scene_does) {
    Scratch scratch;
    StrandPoints strands = hedgehog(40, 9);
    for (auto& strand : strands) std::reverse(strand.begin(), strand.end());
    strands[3].front() = {0, 50, 0};  // a stray tip
    ImportOptions o;
    o.input = scratch.file("hair.data", data_file(strands));
    o.output = scratch.path("out.data");
    o.groom.units = "m", o.groom.up = "y";
    o.order = "tip_first", o.groom.repair = true;
    o.groom.rotation = {0, 0, 90}, o.groom.scale = 2, o.groom.offset = {0, 1, 0};
    EXPECT_EQ(import_command(o), 0);
    const StrandPoints found = import_strands(o.output, {"m", "y"}).strands;
    ASSERT_EQ(found.size(), strands.size());
    EXPECT_EQ(found[3].size(), 8u);
    const Vec3d root = strands[5].back();
    EXPECT_LT(norm(found[5][0] - Vec3d{-2 * root.y, 1 + 2 * root.x, 2 * root.z}), 1e-5);
}

TEST(ImportCommand, leaves_no_output_where_the_input_is_bad) {
    Scratch scratch;
    ImportOptions o;
    o.input = scratch.file("hair.data", data_file(hedgehog(30, 5)).substr(0, 500));
    o.output = scratch.path("out.data");
    expect_error([&] { import_command(o); }, {o.input, "rest of the file"});
    EXPECT_FALSE(std::filesystem::exists(o.output));
    EXPECT_FALSE(std::filesystem::exists(o.output + ".partial"));
}

TEST(RealGroom, harolongo_lies_on_its_head_with_neighbours_near) {
    const std::string shared = WETCURL_SHARED_DIR "/data/";
    if (!std::filesystem::exists(shared + "harolongo.data")) GTEST_SKIP() << "SKIP: no " << shared;
    const std::string scene =
        "file = '" + shared + "harolongo.data'\nunits = 'cm'\nscalp = '" + shared + "female_head.obj'\n";
    const Groom g = load(scene);
    EXPECT_EQ(g.rest.count, 7905);
    const ScalpMesh head(import_mesh(shared + "female_head.obj", {"cm", "y"}));
    const RootDepth depth = root_depth(import_strands(shared + "harolongo.data", {"cm", "y"}).strands, head);
    EXPECT_GT(depth.below, 7000);
    EXPECT_NEAR(depth.median, 0.005, 0.001);
    double sum = 0;
    int pairs = 0;
    for (int r = 0; r < g.grid.height; ++r)
        for (int c = 0; c + 1 < g.grid.width; ++c)
            if (g.grid.at(c, r) >= 0 && g.grid.at(c + 1, r) >= 0) {
                sum += norm(g.rest.at(g.grid.at(c, r), 0) - g.rest.at(g.grid.at(c + 1, r), 0));
                ++pairs;
            }
    EXPECT_LT(sum / pairs, 0.0032);
}

}  // namespace
}  // namespace wetcurl
