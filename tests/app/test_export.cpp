// `wetcurl export`: what was in a run is in the file, in the order in which the strands came in.
#include <cmath>

#include "app/commands/export.h"
#include "app/exchange/guides.h"
#include "base/exchange/scene_file.h"
#include "base/run_cache.h"
#include "solver/grooms/import.h"
#include "solver/scene/scene.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

using testing::bytes_of;
using testing::expect_error;
using testing::Scratch;

constexpr int strands = 6, particles = 5, frames = 4;
constexpr double fps = 24;

// Six strands, the last of the file first, that move along x at one metre a second and are wetter toward
// their tips.
class Export : public ::testing::Test {
  protected:
    Export() {
        RunHeader header;
        header.scene =
            "[groom]\ngrid = [3, 2]\nparticles = 5\n[[solid]]\nshape = \"box\"\nattached = \"head\"\n";
        header.scene_folder = scratch.path();
        header.method = "simulated wet";
        header.fps = fps;
        Groom& groom = header.groom;
        groom.rest = Strands(strands, particles);
        groom.normal.assign(strands, {0, 1, 0});
        groom.grid = {3, 2, {0, 1, 2, 3, 4, 5}};
        groom.origin = origins_of(groom);
        for (int s = 0; s < strands; ++s) {
            groom.origin[size_t(s)].number = strands - 1 - s,
            groom.origin[size_t(s)].id = 100 + strands - 1 - s;
            for (int i = 0; i < particles; ++i) groom.rest.at(s, i) = start(s, i);
        }
        groom.width.assign(size_t(strands * particles), 0);
        for (int i = 0; i < particles; ++i) groom.width[size_t(2 * particles + i)] = 2e-4f - 5e-5f * float(i);
        for (int k = 0; k < strands * particles; ++k)
            header.saturation.push_back(float(k % particles) / (particles - 1));
        RunWriter run(path("run.h5"), header, true);
        for (int f = 0; f < frames; ++f) {
            RunFrame frame;
            frame.positions = groom.rest;
            for (Vec3f& x : frame.positions.points) x.x += float(f / fps);
            frame.displayed = frame.positions;
            for (Vec3f& x : frame.displayed.points) x.z += 0.5f;
            run.append(frame);
        }
        run.commit();
        o.run = path("run.h5"), o.output = path("hair.abc");
    }
    static Vec3f start(int s, int i) { return {0.1f * float(s), -0.01f * float(i), 0.02f * float(s % 2)}; }
    std::string path(const std::string& name) const { return scratch.path(name); }
    std::unique_ptr<SceneReader> exported() {
        EXPECT_EQ(export_command(o), 0);
        return open_scene_file(o.output);
    }

    Scratch scratch;
    ExportOptions o;
};

TEST_F(Export, holds_what_is_displayed_in_the_order_of_the_file) {
    for (const char* name : {"hair.abc", "hair.usda"}) {
        o.output = path(name);
        const auto file = exported();
        ASSERT_EQ(file->curves().size(), 1u);
        const CurvesObject& hair = file->curves()[0];
        EXPECT_EQ(hair.counts, std::vector<int>(strands, particles));
        EXPECT_EQ(hair.ids, (std::vector<int>{100, 101, 102, 103, 104, 105}));
        EXPECT_EQ(hair.basis, CurveBasis::linear);
        ASSERT_EQ(hair.times.size(), size_t(frames));
        for (int f = 0; f < frames; ++f) {
            EXPECT_NEAR(hair.times[size_t(f)], (1 + f) / fps, 1e-9);
            const auto points = file->points_of_curves(0, size_t(f));
            for (int s = 0; s < strands; ++s)
                for (int i = 0; i < particles; ++i) {
                    const Vec3f expected = start(strands - 1 - s, i) + Vec3f{float(f / fps), 0, 0.5f};
                    EXPECT_LT(norm(points[size_t(s * particles + i)] - expected), 1e-6f);
                }
        }
        // A strand of the file that says its widths keeps them; the others are as thick as the scene's hair.
        ASSERT_EQ(hair.widths.size(), size_t(strands * particles));
        for (int i = 0; i < particles; ++i)
            EXPECT_FLOAT_EQ(hair.widths[size_t(3 * particles + i)],
                            2e-4f - 5e-5f * float(i));  // to 0 at its tip
        EXPECT_NEAR(hair.widths[0], std::sqrt(4 * 6.5e-6 / (3.14159265 * 1300)), 1e-8);
    }
}

TEST_F(Export, speaks_the_units_and_axes_of_other_programs) {
    o.target = "maya", o.output = path("maya.usda");
    const auto maya = exported();
    EXPECT_EQ(maya->axes().metres_per_unit, 0.01);
    EXPECT_EQ(maya->axes().up, 'y');
    EXPECT_NEAR(maya->points_of_curves(0, 0)[1].y, -1, 1e-5);
    EXPECT_NEAR(maya->points_of_curves(0, 0)[1].z, 52, 1e-4);  // of strand 5, which came first
    o.target = "unreal", o.output = path("unreal.abc");
    const auto unreal = exported();
    // Stored with z up and mirrored, as Unreal counts; read by us as it was.
    const Vec3f x = unreal->points_of_curves(0, 0)[1];
    EXPECT_NEAR(x.y, -1, 1e-5);
    EXPECT_NEAR(x.z, 52, 1e-4);
    const float stored[] = {x.x, x.z, x.y};
    EXPECT_NE(bytes_of(o.output).find(std::string(reinterpret_cast<const char*>(stored), sizeof stored)),
              std::string::npos);
    const ImportedStrands back = import_strands(o.output, {});
    const ImportedStrands metres = import_strands(path("maya.usda"), {});
    ASSERT_EQ(back.strands.size(), metres.strands.size());
    for (size_t s = 0; s < back.strands.size(); ++s)
        for (size_t i = 0; i < back.strands[s].size(); ++i)
            EXPECT_LT(norm(back.strands[s][i] - metres.strands[s][i]), 1e-6);
    EXPECT_NEAR(unreal->curves()[0].widths[0], 100 * std::sqrt(4 * 6.5e-6 / (3.14159265 * 1300)), 1e-6);
}

TEST_F(Export, takes_some_frames_some_points_and_what_is_simulated) {
    o.frames = "1:3", o.every = 2, o.first_number = 11, o.resample = 9, o.positions = "simulated";
    const auto file = exported();
    const CurvesObject& hair = file->curves()[0];
    ASSERT_EQ(hair.times.size(), 2u);
    EXPECT_NEAR(hair.times[0], 12 / fps, 1e-9);
    EXPECT_NEAR(hair.times[1], 14 / fps, 1e-9);
    EXPECT_EQ(hair.counts, std::vector<int>(strands, 9));
    const auto points = file->points_of_curves(0, 1);
    for (int i = 0; i < 9; ++i)
        EXPECT_LT(norm(points[size_t(i)] - Vec3f{0.5f + float(3 / fps), -0.005f * float(i), 0.02f}), 1e-5f);
}

TEST_F(Export, animates_guides_alone_and_says_who_follows_them) {
    o.guides = 3;
    const auto file = exported();
    ASSERT_EQ(file->curves().size(), 2u);
    const bool guides_first = file->curves()[0].counts.size() == 3;
    const CurvesObject &guides = file->curves()[guides_first ? 0 : 1],
                       &all = file->curves()[guides_first ? 1 : 0];
    EXPECT_EQ(guides.counts.size(), 3u);
    EXPECT_EQ(guides.times.size(), size_t(frames));
    ASSERT_EQ(all.counts.size(), size_t(strands));
    ASSERT_EQ(all.guides.size(), size_t(strands));
    for (size_t s = 0; s < all.guides.size(); ++s) {
        float sum = 0;
        for (size_t k = 0; k < 3; ++k) {
            EXPECT_GE(all.guides[s][k], 0);
            EXPECT_LT(all.guides[s][k], 3);
            sum += all.weights[s][k];
        }
        EXPECT_NEAR(sum, 1, 1e-6);
        const auto guide = std::find(guides.ids.begin(), guides.ids.end(), all.ids[s]);
        if (guide != guides.ids.end()) {
            EXPECT_EQ(all.guides[s][0], guide - guides.ids.begin());
            EXPECT_EQ(all.weights[s][0], 1);
        }
    }
    EXPECT_EQ(guides.is_guide, std::vector<uint8_t>(3, 1));
    EXPECT_EQ(all.is_guide, std::vector<uint8_t>(strands, 0));
    // Unreal's table names guides by their ids.
    ExportOptions unreal = o;
    unreal.target = "unreal", unreal.output = path("unreal.abc");
    EXPECT_EQ(export_command(unreal), 0);
    const auto theirs = open_scene_file(unreal.output);
    for (const CurvesObject& object : theirs->curves())
        for (const auto& nearest : object.guides)
            for (const int id : nearest)
                EXPECT_NE(std::find(guides.ids.begin(), guides.ids.end(), id), guides.ids.end()) << id;
    // What does not move is kept once.
    const size_t bytes = std::filesystem::file_size(o.output);
    o.overwrite = true, o.frames = "0:1";
    exported();
    EXPECT_LT(bytes - std::filesystem::file_size(o.output), size_t(2 * 3 * particles * 3 * 8 + 2000));
}

TEST_F(Export, writes_a_file_of_strands_for_each_frame) {
    for (const char* ending : {".hair", ".data", ".ply", ".obj"}) {
        o.output = path("frame.####") + ending;
        EXPECT_EQ(export_command(o), 0);
        for (int f = 0; f < frames; ++f) {
            const ImportedStrands in =
                import_strands(path("frame.000" + std::to_string(1 + f)) + ending, {"m", "y"});
            ASSERT_EQ(in.strands.size(), size_t(strands)) << ending;
            for (int i = 0; i < particles; ++i)
                EXPECT_LT(norm(cast<float>(in.strands[0][size_t(i)]) - start(strands - 1, i) -
                               Vec3f{float(f / fps), 0, 0.5f}),
                          1e-5f);
        }
    }
    // All names are looked at before the first is written.
    std::filesystem::remove(path("frame.0001.obj"));
    expect_error([&] { export_command(o); }, {"frame.0002.obj", "--overwrite"});
    EXPECT_FALSE(std::filesystem::exists(path("frame.0001.obj")));
    // Folders are made, and what a file says of its unit is so.
    o.output = path("new/frame.####.obj"), o.target = "maya";
    EXPECT_EQ(export_command(o), 0);
    EXPECT_NE(bytes_of(path("new/frame.0001.obj")).find("strands, centimetres, Y up"), std::string::npos);
    o.target = "";
    o.output = path("one.data"), o.frames = "2";
    EXPECT_EQ(export_command(o), 0);
    EXPECT_TRUE(std::filesystem::exists(o.output));
}

TEST_F(Export, writes_the_solids_into_a_file_of_their_own) {
    o.solids = path("solids.usda");
    exported();
    const auto file = open_scene_file(o.solids);
    ASSERT_EQ(file->meshes().size(), 1u);
    EXPECT_EQ(file->meshes()[0].points, 8u);
    EXPECT_NEAR(std::abs(file->points_of_mesh(0, 0)[0].x), 0.1, 1e-6);
}

// A run that goes on with another one from its frame 2 on.
TEST_F(Export, of_a_later_part_has_its_solids_and_cuts_where_they_are_then) {
    RunHeader header = RunReader(o.run).header();
    header.scene =
        "fps = 24\n[groom]\ngrid = [3, 2]\nparticles = 5\n[[solid]]\nshape = "
        "\"box\"\n[[solid.motion.keyframe]]"
        "\n[[solid.motion.keyframe]]\ntime = 1\ntranslation = [1, 0, 0]\n[motion]\ncuts = [4]\n";
    header.start = 2 / fps;
    RunWriter run(path("later.h5"), header, true);
    for (int f = 0; f < frames; ++f) {
        RunFrame frame;
        frame.positions = header.groom.rest;
        for (Vec3f& x : frame.positions.points) x.x += f < 2 ? 0.f : 10.f;
        frame.displayed = frame.positions;
        run.append(frame);
    }
    run.commit();
    o.run = path("later.h5"), o.output = path("later.usda"), o.solids = path("later_solids.usda");
    const auto hair = exported();
    const auto solids = open_scene_file(o.solids);
    const Motion motion = parse_scene(header.scene, "scene.toml", ".").solids[0].motion;
    for (int f = 0; f < frames; ++f)
        EXPECT_NEAR(std::abs(solids->points_of_mesh(0, size_t(f))[0].x -
                             float(motion.at((2 + f) / fps).translation.x)),
                    0.1, 1e-5);
    // Nothing moves but across the cut, which has no velocity.
    EXPECT_EQ(bytes_of(o.output).find("240"), std::string::npos);
}

TEST_F(Export, refuses_what_cannot_be_meant) {
    auto refused = [&](std::initializer_list<std::string> parts) {
        expect_error<Misuse>([&] { export_command(o); }, parts);
    };
    o.output = path("hair.fbx"), refused({".fbx", ".abc", ".data"});
    o.output = path("hair.data"), refused({"4 frames", "####"});
    o.frames = "1:9", refused({"--frames", "0 to 3"});
    o.frames = "a", refused({"--frames", "FIRST:LAST"});
    o.frames = "", o.output = path("a.####.data"), o.guides = 2, refused({"--guides"});
    o.output = path("hair.abc"), o.guides = 7, refused({"--guides", "1 to 6"});
    o.guides = 0, o.solids = o.output, refused({"--solids"});
    o.solids = "", o.every = 0, refused({"--every"});
    EXPECT_FALSE(std::filesystem::exists(path("hair.abc")));
    o.every = 1, exported();
    expect_error([&] { export_command(o); }, {"hair.abc", "--overwrite"});
}

TEST(Guides, spread_and_are_nearest) {
    std::vector<Vec3f> roots;
    for (int r = 0; r < 9; ++r)
        for (int c = 0; c < 9; ++c) roots.push_back({float(c), 0, float(r)});
    const Guides guides = guides_of(roots, 4);
    // Four of a square's points, as far from each other as can be, are its corners.
    EXPECT_EQ(guides.strands, (std::vector<int>{0, 8, 72, 80}));
    EXPECT_EQ(guides.nearest[10][0], 0);
    EXPECT_GT(guides.weights[10][0], guides.weights[10][1]);
    EXPECT_GE(guides.weights[10][1], guides.weights[10][2]);
    // All strands may be guides, and few, and roots may lie on each other.
    EXPECT_EQ(guides_of(roots, 81).strands.size(), 81u);
    const Guides one = guides_of(roots, 1), same = guides_of(std::vector<Vec3f>(5, {0, 0, 0}), 3);
    for (size_t s = 0; s < roots.size(); ++s) EXPECT_FLOAT_EQ(one.weights[s][0], 1);
    EXPECT_EQ(same.strands.size(), 3u);
}

}  // namespace
}  // namespace wetcurl
