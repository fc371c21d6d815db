// Characters of a shot: files of animated meshes, cuts, the way from rest to the first frame, units and axes,
// meshes that are not as they should be.
#include <fmt/format.h>

#include <cstdio>
#include <filesystem>
#include <map>

#include "base/geometry/mesh_winding.h"
#include "base/log.h"
#include "solver/scene/findings.h"
#include "tests/solver/characters.h"

namespace wetcurl {
namespace {

using namespace testing;

const std::string springs = "[stretch]\n[bend]\n[core]\n[stiffness]\nglobal = 3\n";
const std::string soft = "[stretch]\n[bend]\nstiffness = 2e-4\n[stiffness]\nglobal = 3\n";
const std::string weightless = "[integrator]\nsubsteps = 6\ngravity = [0, 0, 0]\n";

std::vector<StandingStrand> on_top() {
    std::vector<StandingStrand> out;
    for (int k = 0; k < 16; ++k) {
        const double y = 0.95 - 0.04 * k, r = std::sqrt(1 - y * y), turn = 2.4 * k;
        const Vec3d n{r * std::cos(turn), y, r * std::sin(turn)};
        out.push_back({0.1004 * n, n});
    }
    return out;
}
Vec3d nods(const Vec3d& x, double time) {
    const Vec3d wide = (1 + 0.1 * std::sin(3 * time)) * x;
    return rotate(rotation_about({1, 0, 0}, 0.8 * std::sin(4 * time)), wide) + Vec3d{0.3 * time, 0, 0};
}

std::string said_by(const std::function<void()>& act) {
    ::testing::internal::CaptureStderr();
    act();
    return ::testing::internal::GetCapturedStderr();
}

// --- files

// The same mesh in files of several kinds, 24 frames a second, from number 1 on.
void write_frames(const Scratch& scratch, const Mesh& rest, const Warp& warp, int count, double unit = 1) {
    for (const char* ending : {"usda", "abc"}) {
        SceneFileSettings settings;
        settings.metres_per_unit = unit;
        const auto file = create_scene_file(scratch.path(std::string("body.") + ending), true, settings);
        MeshObject object;
        object.path = "/body/skin";
        for (const auto& t : rest.triangles) {
            object.counts.push_back(3);
            object.corners.insert(object.corners.end(), t.begin(), t.end());
        }
        object.points = rest.vertices.size();
        const size_t skin = file->add_mesh(object);
        object.path = "/body/shirt";
        const size_t shirt = file->add_mesh(object);
        for (int k = 0; k < count; ++k) {
            Mesh now = warped(rest, warp, k / 24.0);
            for (auto& v : now.vertices) v = float(1 / unit) * v;
            file->append_mesh(skin, now.vertices);
            for (auto& v : now.vertices) v.y += float(1 / unit);
            file->append_mesh(shirt, now.vertices);
        }
        file->finish();
    }
    for (int k = 0; k < count; ++k) {
        char name[32];
        std::snprintf(name, sizeof name, "body.%04d.obj", k + 1);
        scratch.file(name, obj_of(warped(rest, warp, k / 24.0)));
    }
}

TEST(Characters, files_of_any_kind_move_as_keyframes_of_their_meshes_do) {
    const Scratch scratch;
    const Mesh ball = triangulated(Sphere{0.1}, 24);
    write_frames(scratch, ball, nods, 9);
    const std::string groom = standing(scratch, on_top(), 0.1, 10, "body") + weightless + springs,
                      solid = "[[solid]]\nname = \"body\"\nshape = \"mesh\"\nspacing = 0.02\n";
    const Scene keys = scene_of("frames = 8\n" + groom + solid + mesh_keyframes(scratch, ball, nods, 24, 9));
    RidingRoots::Room wanted, found;
    for (const std::string file :
         {"body.####.obj\"", "body.usda\"\nobject = \"/body/skin\"", "body.abc\"\nobject = \"/body/skin\""}) {
        const Scene scene =
            scene_of("frames = 8\n" + groom + solid + "file = \"" + scratch.path() + "/" + file + "\n");
        ASSERT_TRUE(scene.riding) << file;
        for (double time : {0.0, 0.1, 0.2, 0.33, 0.5}) {
            keys.root_poses_at(time, wanted), scene.root_poses_at(time, found);
            for (size_t s = 0; s < wanted.pose.size(); ++s)
                EXPECT_LT(norm(wanted.pose[s]({0.1, 0.1, 0}) - found.pose[s]({0.1, 0.1, 0})), 1e-6)
                    << file << time;
        }
    }
    // From another frame on, at another rate.
    const Scene late = scene_of("frames = 4\n" + groom + solid + "file = \"" + scratch.path() +
                                "/body.####.obj\"\nfile_fps = 12\nfirst_file_frame = 3\n");
    for (int k = 0; k < 5; ++k) {
        const Mesh there = late.solids[0].deformation->at(k / 12.0),
                   here = keys.solids[0].deformation->at((2 + k) / 24.0);
        for (size_t v = 0; v < here.vertices.size(); ++v)
            EXPECT_LT(norm(there.vertices[v] - here.vertices[v]), 1e-6f) << k;
    }
}

// Counts what is read.
struct CountedFrames : MeshFrames {
    Mesh mesh = triangulated(Sphere{0.1}, 12);
    mutable int read = 0;
    explicit CountedFrames(int count) {
        for (int k = 0; k < count; ++k) times_.push_back(k / 24.0);
        triangles_ = mesh.triangles;
    }
    std::vector<Vec3f> vertices(size_t frame) const override {
        ++read;
        return warped(mesh, nods, times_[frame]).vertices;
    }
    std::string name_of(size_t) const override { return ""; }
};

TEST(Characters, few_frames_of_a_file_are_in_memory_and_each_is_read_once) {
    auto frames = std::make_unique<CountedFrames>(60);
    const CountedFrames& counted = *frames;
    const Deformation deformation(std::move(frames), {}, 0);
    std::vector<Vec3f> out;
    size_t most = 0;
    for (int k = 0; k < 590; ++k) {
        deformation.vertices_at(k / 240.0, out);
        if (k > 0) deformation.vertices_at((k - 1) / 240.0, out);
        most = std::max(most, deformation.frames_in_memory());
    }
    EXPECT_LE(most, 5u);
    EXPECT_EQ(counted.read, 60);
}

TEST(Characters, a_run_that_goes_on_later_sees_the_mesh_where_it_is_then) {
    const Scratch scratch;
    const Mesh ball = triangulated(Sphere{0.1}, 12);
    const auto walks = [](const Vec3d& x, double time) { return x + Vec3d{2 * time, 0, 0}; };
    write_frames(scratch, ball, walks, 30);
    const std::string scene =
        "frames = 4\n[groom]\ngrid = [2, 2]\n[stretch]\n[[solid]]\nshape = \"mesh\"\nfile = \"" +
        scratch.path("body.####.obj") + "\"\n";
    const auto farthest = [&](const SceneOptions& options) {
        return parse_scene(scene, "scene.toml", ".", options).solids[0].region.high.x;
    };
    EXPECT_NEAR(farthest({}), 0.1 + 2 * 4 / 24.0, 0.1);
    SceneOptions later, endless;
    later.start = 1, endless.endless = true;
    EXPECT_NEAR(farthest(later), 0.1 + 2 * 28 / 24.0, 0.1);
    EXPECT_NEAR(farthest(endless), 0.1 + 2 * 29 / 24.0, 0.01);
}

TEST(Characters, says_what_is_wrong_with_their_files) {
    const Scratch scratch;
    const Mesh ball = triangulated(Sphere{0.1}, 12);
    write_frames(scratch, ball, nods, 3);
    const auto refuses = [&]<class E = Error>(const std::string& more,
                                              std::initializer_list<std::string> parts) {
        expect_error<E>(
            [&] { scene_of("[groom]\ngrid = [2, 2]\n[stretch]\n[[solid]]\nshape = \"mesh\"\n" + more); },
            parts);
    };
    const auto file = [&](const std::string& name) { return "file = \"" + scratch.path(name) + "\"\n"; };
    refuses(file("body.usda") + "object = \"/body/hat\"\n",
            {"scene.toml:7", "/body/hat", "/body/skin", "/body/shirt"});
    refuses(file("head.####.obj"), {"scene.toml:6", "head.####.obj", "#"});
    refuses(file("none.abc"), {"scene.toml:6", "none.abc"});
    refuses(file("body.0001.obj") + "object = \"/body/skin\"\n", {"scene.toml:7", "object", "animated"});
    refuses(file("body.usda") + "file_fps = 12\n", {"scene.toml:7", "file_fps", "first_file_frame"});
    expect_error(
        [&] {
            scene_of("[groom]\nscalp = \"bodi\"\n[stretch]\n[[solid]]\nname = \"body\"\nshape = \"mesh\"\n" +
                     file("body.usda"));
        },
        {"scene.toml:2", "bodi", "[[solid]]", "are body"});
    scratch.file("body.0002.obj", obj_of(triangulated(Sphere{0.1}, 16)));
    refuses(file("body.####.obj") + "spacing = 0.02\n", {"body.0002.obj", "triangles", "body.0001.obj"});
}

// --- cuts

const std::string teleport =
    "fps = 24\nframes = 12\n[groom]\ngrid = [6, 6]\nparticles = 40\nlength = 0.2\n[integrator]\nsubsteps = "
    "8\n" +
    springs +
    "[[motion.keyframe]]\n[[motion.keyframe]]\ntime = 0.0416666\n[[motion.keyframe]]\ntime = 0.0833333\n"
    "translation = [15, 0, 3]\nrotation = [0, 90, 0]\n[[motion.keyframe]]\ntime = 1\ntranslation = [15, 0, "
    "3]\n"
    "rotation = [0, 90, 0]\n[[solid]]\nname = \"head\"\nradius = 0.095\nattached = \"head\"\n[motion]\n";

TEST(Characters, hair_begins_anew_at_a_cut) {
    const auto widest_and_longest = [](const Scene& scene) {
        const auto simulation = make_simulation(scene, "float");
        double spread = 0, strain = 0, speed = 0;
        for (int f = 1; f <= 12; ++f) {
            simulation->advance();
            RunFrame frame;
            simulation->snapshot(frame);
            const auto v = simulation->state().v;
            for (const Vec3d& each : v) speed = std::max(speed, norm(each));
            for (int s = 0; s < frame.positions.count; ++s) {
                const auto at = [&](int i) { return cast<double>(frame.positions.at(s, i)); };
                for (int i = 0; i + 1 < frame.positions.particles; ++i) {
                    const double rest = norm(cast<double>(scene.groom.rest.at(s, i + 1)) -
                                             cast<double>(scene.groom.rest.at(s, i)));
                    strain = std::max(strain, norm(at(i + 1) - at(i)) / rest);
                }
                spread = std::max(spread, norm(at(frame.positions.particles - 1) - frame.head.translation));
            }
        }
        return std::array{spread, strain, speed};
    };
    const auto [cut_spread, cut_strain, cut_speed] =
        widest_and_longest(scene_of(teleport + "cuts = [2]\n", {"integrator.settle_after_cut=0"}));
    const auto [still_spread, still_strain, still_speed] =
        widest_and_longest(scene_of(teleport, {"motion.cuts=[2]"}));
    std::printf(
        "a cut of 15 m and a quarter turn: edges at most %.3f of rest, tips up to %.2f m/s and %.2f m from "
        "the head\n",
        cut_strain, cut_speed, cut_spread);
    EXPECT_LT(cut_strain, 1.05);
    EXPECT_LT(still_strain, 1.05);
    // As far as the strands are long, and no faster than a fall over their length.
    EXPECT_LT(cut_spread, 0.095 + 0.23);
    EXPECT_LT(cut_speed, std::sqrt(2 * 9.81 * 0.25));
    EXPECT_LE(still_speed, cut_speed);
}

TEST(Characters, at_a_cut_each_strand_is_carried_with_its_root) {
    const Scratch scratch;
    const Warp jumps = [](const Vec3d& x, double time) {
        return time < 0.1 ? x : rotate(rotation_about({0, 0, 1}, 1.2), 1.2 * x) + Vec3d{3, 0, 0};
    };
    const Mesh ball = triangulated(Sphere{0.1}, 24);
    const Scene scene =
        scene_of("frames = 8\n" + standing(scratch, on_top(), 0.1, 10, "body") + weightless + springs +
                 "[motion]\ncuts = [3]\n[[solid]]\nname = \"body\"\nshape = \"mesh\"\nspacing = 0.01\n" +
                 mesh_keyframes(scratch, ball, jumps, 24, 8));
    const auto simulation = make_simulation(scene, "double");
    for (int f = 0; f < 8; ++f) simulation->advance();
    RidingRoots::Room room;
    scene.root_poses_at(8 / 24.0, room);
    const auto state = simulation->state();
    const size_t n = size_t(scene.groom.rest.particles);
    for (size_t k = 0; k < state.x.size(); ++k) {
        const Vec3d wanted = room.pose[k / n](cast<double>(scene.groom.rest.points[k]));
        EXPECT_LT(norm(state.x[k] - wanted), 2e-4);  // at rest before the cut and after it
        EXPECT_LT(norm(state.v[k]), 0.02);
    }
    EXPECT_GT(norm(room.pose[0].translation), 2);
}

TEST(Characters, what_looks_like_a_cut_is_one_and_is_said) {
    const std::string said = said_by([] {
        EXPECT_EQ(scene_of(teleport).cuts.frames, std::vector<int>{2});
        // However few frames follow.
        EXPECT_EQ(scene_of(teleport, {"frames=2"}).cuts.frames, std::vector<int>{2});
        EXPECT_TRUE(scene_of(teleport, {"frames=1"}).cuts.frames.empty());
    });
    for (const char* part : {"15.3 m", "frame 1 to frame 2", "guessed", "cuts = [2]", "[motion]"})
        EXPECT_NE(said.find(part), std::string::npos) << said;
    EXPECT_EQ(farthest(after(scene_of(teleport), 4).positions,
                       after(scene_of(teleport + "cuts = [2]\n"), 4).positions),
              0);
    EXPECT_EQ(said_by([] { scene_of(teleport + "cuts = [2]\n"); }).find("cuts"), std::string::npos);
    EXPECT_EQ(
        said_by([] { EXPECT_TRUE(scene_of(teleport + "cuts = []\n").cuts.frames.empty()); }).find("cuts"),
        std::string::npos);
    EXPECT_NE(said_by([] { scene_of(teleport + "cuts = [7]\n"); }).find("does not name frame 2"),
              std::string::npos);
    EXPECT_NE(
        said_by([] { scene_of(teleport + "cuts = [2, 12]\n"); }).find("frame 12 comes after the last, 11"),
        std::string::npos);
    // A turn on the spot is one too.
    EXPECT_NE(said_by([] {
                  scene_of(dry_scene +
                           "[[motion.keyframe]]\n[[motion.keyframe]]\ntime = 0.125\n"
                           "[[motion.keyframe]]\ntime = 0.1666667\nrotation = [0, 170, 0]\n"
                           "[[motion.keyframe]]\ntime = 1\nrotation = [0, 170, 0]\n");
              }).find("cuts = [4]"),
              std::string::npos);
    // A fast swing is none.
    EXPECT_EQ(said_by([] {
                  scene_of(dry_scene + "[motion]\nangle = 90\nperiod = 0.4\nshift = [0.4, 0, 0]\n");
              }).find("cuts ="),
              std::string::npos);
}

TEST(Characters, a_solid_that_is_cut_to_elsewhere_strikes_nothing_on_its_way) {
    const std::string ball =
        "[[solid]]\nradius = 0.08\n[[solid.motion.keyframe]]\ntime = 0.0834\ntranslation = [-1, 0, -0.1]\n"
        "[[solid.motion.keyframe]]\ntime = 0.1249\ntranslation = [1, 0, -0.1]\n[solid.motion]\n";
    const Strands still = after(scene_of(dry_scene), 8).positions,
                  cut = after(scene_of(dry_scene + ball + "cuts = [3]\n"), 8).positions,
                  struck = after(scene_of(dry_scene + ball + "cuts = []\n"), 8).positions,
                  found = after(scene_of(dry_scene + ball), 8).positions;
    ASSERT_GT(farthest(struck, still), 0.01);
    EXPECT_LT(farthest(cut, still), 1e-4);
    EXPECT_EQ(farthest(found, cut), 0);
}

// --- the pose of the hair

TEST(Characters, hair_is_bound_to_the_frame_of_the_file_in_which_it_was_made) {
    const Scratch scratch;
    const Mesh ball = triangulated(Sphere{0.1}, 24);
    const Warp grown = [](const Vec3d& x, double time) {
        return Vec3d{(1 + time) * x.x, x.y, x.z} + Vec3d{0.5, time, 0};
    };
    const std::string rest = scratch.file("rest.obj", obj_of(ball));
    for (int frame = 0; frame < 4; ++frame) {
        const Mesh now = frame ? warped(ball, grown, frame / 24.0) : ball;
        scratch.file("body.000" + std::to_string(frame) + ".obj", obj_of(now));
    }
    const auto poses = [&](const std::string& pose) {
        const Scene scene =
            scene_of("frames = 2\n" + standing(scratch, on_top(), 0.1, 10, "body") + weightless + springs +
                     "[[solid]]\nname = \"body\"\nshape = \"mesh\"\nspacing = 0.01\nfile = \"" +
                     scratch.path("body.####.obj") + "\"\nfirst_file_frame = 1\n" + pose);
        RidingRoots::Room room;
        scene.root_poses_at(0, room);
        return room.pose;
    };
    const auto of_file = poses("rest = \"" + rest + "\"\n"), of_frame = poses("rest_frame = 0\n");
    ASSERT_EQ(of_frame.size(), of_file.size());
    for (size_t s = 0; s < of_file.size(); ++s)
        EXPECT_EQ(norm(of_frame[s]({0.1, 0.2, 0.3}) - of_file[s]({0.1, 0.2, 0.3})), 0);
    EXPECT_GT(norm(of_frame[0]({0, 0, 0})), 0.4);
    expect_error<Misuse>([&] { poses("rest_frame = 7\n"); }, {"rest_frame", "found 7", "frames 0 to 3"});
    expect_error<Misuse>([&] { poses("rest_frame = 0\nrest = \"" + rest + "\"\n"); },
                         {"rest_frame", "beside rest"});
}

// A mesh of a .usda; `points`: the line, or lines, of them.
std::string usda_mesh(const std::string& name, const Mesh& mesh, const std::string& points) {
    std::vector<std::string> counts, corners;
    for (const auto& t : mesh.triangles) {
        counts.push_back("3");
        for (const int corner : t) corners.push_back(std::to_string(corner));
    }
    return fmt::format(
        "def Mesh \"{}\"\n{{\n    int[] faceVertexCounts = [{}]\n    int[] faceVertexIndices = [{}]\n    "
        "{}\n}}\n",
        name, fmt::join(counts, ", "), fmt::join(corners, ", "), points);
}
// "[(x, y, z), ...]", moved along x.
std::string usda_points(const Mesh& mesh, float by) {
    std::vector<std::string> out;
    for (const Vec3f& v : mesh.vertices) out.push_back(fmt::format("({:f}, {:f}, {:f})", v.x + by, v.y, v.z));
    return fmt::format("[{}]", fmt::join(out, ", "));
}
constexpr const char* usda_head =
    "#usda 1.0\n(\n    startTimeCode = 1\n    endTimeCode = 24\n    timeCodesPerSecond = 24\n"
    "    metersPerUnit = 1\n    upAxis = \"Y\"\n)\n";

// From frame `first` to 24 it moves by a metre along x.
std::string usda_that_moves(const Mesh& mesh, int first) {
    return usda_head +
           usda_mesh(
               "body", mesh,
               fmt::format("point3f[] points.timeSamples = {{\n        {}: {},\n        24: {},\n    }}",
                           first, usda_points(mesh, 0), usda_points(mesh, 1)));
}

// A shot from frame 1 to 24 whose mesh holds still until frame 12: what repeats is left out of the file.
TEST(Characters, a_mesh_holds_still_from_the_begin_of_its_shot_to_its_first_sample) {
    const Scratch scratch;
    const Mesh ball = triangulated(Sphere{0.1}, 12);
    const std::string file = scratch.file("body.usda", usda_that_moves(ball, 12));
    const auto times = [&](const std::string& more, const std::string& fps = "24") {
        const Scene scene = scene_of(
            "fps = " + fps + "\nframes = 2\n" + dry_scene.substr(dry_scene.find('[')) +
            "[[solid]]\nname = \"body\"\nshape = \"mesh\"\nspacing = 0.02\nfile = \"" + file + "\"\n" + more);
        return scene.solids.at(0).deformation->times();
    };
    EXPECT_NEAR(times("").front(), 11 / 24.0, 1e-9);
    EXPECT_NEAR(times("first_file_frame = 12\n").front(), 0, 1e-9);
    // The file says how many frames a second it counts, whatever the scene's are.
    EXPECT_NEAR(times("first_file_frame = 12\n", "30").front(), 0, 1e-9);
    EXPECT_NEAR(times("rest_frame = 5\n").front(), 11 / 24.0, 1e-9);
    expect_error<Misuse>([&] { times("rest_frame = 0\n"); }, {"rest_frame", "found 0", "frames 1 to 24"});
    expect_error<Misuse>([&] { times("rest_frame = 25\n"); }, {"rest_frame", "found 25"});
    expect_error<Misuse>([&] { times("object = \"/no\"\n"); }, {"object", "found no mesh '/no'", "/body"});
}

TEST(Characters, a_mesh_whose_frames_begin_late_or_end_before_the_scene_is_told_of) {
    const Scratch scratch;
    const Mesh ball = triangulated(Sphere{0.1}, 12);
    const std::string file = scratch.file("body.usda", usda_that_moves(ball, 1));
    const auto said = [&](int first_file_frame) {
        ::testing::internal::CaptureStderr();
        scene_of("fps = 24\nframes = 12\n" + dry_scene.substr(dry_scene.find('[')) +
                 "[[solid]]\nname = \"body\"\nshape = \"mesh\"\nspacing = 0.02\nfile = \"" + file +
                 "\"\nfirst_file_frame = " + std::to_string(first_file_frame) + "\n");
        return ::testing::internal::GetCapturedStderr();
    };
    const auto tells = [&](int frame, const std::string& words) {
        return said(frame).find(words) != std::string::npos;
    };
    EXPECT_TRUE(tells(-9, "begins at frame 10 of the scene"));
    EXPECT_TRUE(tells(50, "ends before the scene begins"));
    EXPECT_TRUE(tells(20, "ends at frame 4 of the scene"));
    EXPECT_FALSE(tells(1, "stands still"));
}

// Of a file of several meshes the one that is animated; where there is one alone, it, whatever its name.
TEST(Characters, the_pose_of_the_hair_is_that_of_the_object) {
    const Scratch scratch;
    const Mesh ball = triangulated(Sphere{0.1}, 12), other = triangulated(Sphere{0.05}, 8);
    const auto file = [&](const std::string& name, const std::string& meshes) {
        return scratch.file(name, usda_head + meshes);
    };
    const auto still = [](const std::string& name, const Mesh& mesh, float by) {
        return usda_mesh(name, mesh, "point3f[] points = " + usda_points(mesh, by));
    };
    const std::string body = file("body.usda", still("eyes", other, 0) + still("body", ball, 0.5f));
    const auto root = [&](const std::string& rest) {
        const Scene scene =
            scene_of("frames = 2\n" + standing(scratch, on_top(), 0.1, 10, "body") + weightless + springs +
                     "[[solid]]\nname = \"body\"\nshape = \"mesh\"\nspacing = 0.02\n" +
                     "object = \"/body\"\nfile = \"" + body + "\"\nrest = \"" + rest + "\"\n");
        RidingRoots::Room room;
        scene.root_poses_at(0, room);
        return room.pose.at(0)({0, 0, 0});
    };
    const std::string both = file("both.usda", still("eyes", other, 3) + still("body", ball, 0)),
                      alone = file("alone.usda", still("skin", ball, 0)),
                      wrong = file("wrong.usda", still("eyes", other, 0) + still("skin", ball, 0));
    for (const std::string& rest : {both, alone}) EXPECT_NEAR(root(rest).x, 0.5, 1e-5) << rest;
    expect_error<Misuse>([&] { root(wrong); }, {"rest", "found no mesh '/body'", "/skin"});
}

// --- preroll

TEST(Characters, the_preroll_leads_from_the_shape_of_the_hair_to_the_first_frame) {
    const Scratch scratch;
    const Mesh ball = triangulated(Sphere{0.1}, 24);
    const Warp elsewhere = [](const Vec3d& x, double) {
        return rotate(rotation_about({0, 1, 0}, 1.9), Vec3d{1.1 * x.x, x.y, x.z}) + Vec3d{0.5, 1.4, 0};
    };
    const std::string rest = scratch.file("rest.obj", obj_of(ball));
    const Scene scene =
        scene_of("frames = 4\n" + standing(scratch, on_top(), 0.1, 10, "body") + weightless + springs +
                 "[motion]\npreroll = 0.5\n[[solid]]\nname = \"body\"\nshape = \"mesh\"\nspacing = 0.01\n"
                 "rest = \"" +
                 rest + "\"\n" + mesh_keyframes(scratch, ball, elsewhere, 24, 5));
    RidingRoots::Room room, later;
    scene.root_poses_at(scene.begin(), room);
    for (const Pose& pose : room.pose) EXPECT_LT(norm(pose({0.3, 0.2, 0.1}) - Vec3d{0.3, 0.2, 0.1}), 1e-9);
    // No jump on the way, and none of its speed at the ends.
    double fastest = 0;
    for (int k = 1; k <= 240; ++k) {
        scene.root_poses_at(-0.5 + (k - 1) / 480.0, room), scene.root_poses_at(-0.5 + k / 480.0, later);
        const double speed = 480 * norm(later.pose[5]({0, 0.1, 0}) - room.pose[5]({0, 0.1, 0}));
        fastest = std::max(fastest, speed);
        if (k == 1 || k == 240) {
            EXPECT_LT(speed, 0.2);
        }
    }
    EXPECT_LT(fastest, 10);
    const auto simulation = make_simulation(scene, "double");
    scene.root_poses_at(0, room);
    const auto x = simulation->state().x;
    const size_t n = size_t(scene.groom.rest.particles);
    for (size_t s = 0; s < room.pose.size(); ++s) {
        EXPECT_LT(norm(x[s * n] - room.pose[s](cast<double>(scene.groom.rest.at(int(s), 0)))), 1e-9);
        EXPECT_LT(
            norm(x[s * n + n - 1] - room.pose[s](cast<double>(scene.groom.rest.at(int(s), int(n) - 1)))),
            0.12);
    }
    RunFrame frame;
    simulation->snapshot(frame);
    EXPECT_GT(norm(frame.head.translation), 1);
}

// --- level sets of characters

TEST(Characters, a_body_that_walks_keeps_hair_out_of_it) {
    const Scratch scratch;
    const Tube tube{0.5, 0.1, 96, 120};
    const Warp walks = [](const Vec3d& x, double time) {
        const Vec3d bent{x.x + 0.1 * std::sin(3 * time) * (x.y + 0.6) * (x.y + 0.6), x.y, x.z};
        return rotate(rotation_about({0, 1, 0}, 0.7 * time), bent) +
               Vec3d{1.5 * time, 0.02 * std::sin(12 * time), 0};
    };
    std::vector<StandingStrand> strands;
    for (int k = 0; k < 40; ++k) {
        const double turn = 2.399 * k, y = 0.52 + 0.07 * k / 39, r = std::sqrt(0.01 - (y - 0.5) * (y - 0.5));
        const Vec3d skin{r * std::cos(turn), y, r * std::sin(turn)},
            n = normalized(skin - Vec3d{0, 0.5, 0}, {0, 1, 0});
        strands.push_back({skin + 0.0005 * n, n});
    }
    write_frames(scratch, tube.mesh(), walks, 49);
    const Scene scene = scene_of("frames = 48\n" + standing(scratch, strands, 0.25, 24, "body") +
                                 "[integrator]\nsettle = 0.5\n" + soft +
                                 "[[solid]]\nname = \"body\"\nshape = \"mesh\"\nfile = \"" + scratch.path() +
                                 "/body.####.obj\"\n");
    const auto simulation = make_simulation(scene, "float");
    double deepest = 0, nearest = 1;
    for (int f = 1; f <= 48; ++f) {
        simulation->advance();
        RunFrame frame;
        simulation->snapshot(frame);
        const MeshDistance body(warped(tube.mesh(), walks, f / 24.0));
        for (int s = 0; s < frame.positions.count; ++s)
            for (int i = 2; i < frame.positions.particles; ++i) {
                const Vec3d x = cast<double>(frame.positions.at(s, i));
                const double distance = body.closest(x).distance;
                if (body.inside(x)) deepest = std::max(deepest, distance);
                if (i > 12) nearest = std::min(nearest, distance);
            }
    }
    std::printf("a body that walks 3 m: hair at most %.3g mm in it\n", 1000 * deepest);
    EXPECT_LT(nearest, 2e-3);  // hair lies on it
    EXPECT_LT(deepest, 2e-3);
}

// --- what is not said

TEST(Characters, hair_on_a_head_that_deforms_rides_on_it_unsaid_and_this_is_said) {
    const Scratch scratch;
    const Mesh ball = triangulated(Sphere{0.1}, 24);
    const Warp aside = [](const Vec3d& x, double time) { return x + Vec3d{0.15 * time, 0, 0}; };
    const std::string groom = standing(scratch, on_top(), 0.1, 10, "head") + weightless + springs,
                      unsaid =
                          [&] {
                              std::string text = groom;
                              const size_t at = text.find("scalp = \"head\"\n");
                              return text.erase(at, text.find('\n', at) + 1 - at);
                          }(),
                      head =
                          "[[solid]]\nname = \"head\"\nattached = \"head\"\nshape = \"mesh\"\nspacing = "
                          "0.02\n" +
                          mesh_keyframes(scratch, ball, aside, 1, 2);
    const std::string said = said_by([&] {
        const Scene scene = scene_of("frames = 8\n" + unsaid + head);
        EXPECT_TRUE(scene.riding);
        // Strands in the order of their file: a scalp lays them on another grid.
        const auto in_order = [](const Scene& of) {
            const Strands there = after(of, 8).positions;
            std::map<int, Vec3f> tips;
            for (int s = 0; s < there.count; ++s)
                tips[of.groom.origin[size_t(s)].number] = there.at(s, there.particles - 1);
            return tips;
        };
        const auto tips = in_order(scene), told = in_order(scene_of("frames = 8\n" + groom + head));
        for (const auto& [number, tip] : tips) EXPECT_LT(norm(tip - told.at(number)), 1e-6f) << number;
    });
    for (const char* part : {"guessed", "scalp = \"head\"", "mm from"})
        EXPECT_NE(said.find(part), std::string::npos) << said;
    // Apart from a head nothing is guessed, and a finding says what is missing.
    std::string apart = head;
    apart.replace(apart.find("attached = \"head\"\n"), 18, "");
    const Scene scene = scene_of("frames = 8\n" + unsaid + apart);
    EXPECT_FALSE(scene.riding);
    const auto findings = findings_of(scene);
    EXPECT_TRUE(std::any_of(findings.begin(), findings.end(),
                            [](const Finding& f) { return f.remedy == "scalp = \"head\" in [groom]"; }));
}

TEST(Characters, findings_name_what_is_wrong_with_a_mesh) {
    const Scratch scratch;
    Mesh mesh = triangulated(Sphere{0.1}, 24);
    const auto once = mesh.triangles;
    for (const auto& t : once) mesh.triangles.push_back({t[0], t[2], t[1]});
    const Mesh sheet{{{0, 0, 0}, {0.1f, 0, 0}, {0, 0, 0.1f}, {0.1f, 0.02f, 0.1f}}, {{0, 1, 2}, {1, 3, 2}}};
    const Scene scene = scene_of(
        "[groom]\ngrid = [4, 4]\n[stretch]\n[[solid]]\nname = \"skull\"\nspacing = "
        "0.02\nshape = \"mesh\"\nfile = \"" +
        scratch.file("skull.obj", obj_of(mesh)) +
        "\"\n[[solid]]\nname = \"cape\"\nspacing = 0.02\nshape = \"mesh\"\nfile = \"" +
        scratch.file("cape.obj", obj_of(sheet)) + "\"\n");
    std::string all;
    for (const Finding& finding : findings_of(scene)) all += described(finding) + "\n";
    const std::string counts = std::to_string(once.size()) + " of " + std::to_string(2 * once.size());
    for (const std::string& part : {std::string("doubled_faces: [[solid]] 'skull'"), counts,
                                    std::string("no_inside: [[solid]] 'cape'")})
        EXPECT_NE(all.find(part), std::string::npos) << all;
    EXPECT_EQ(all.find("no_inside: [[solid]] 'skull'"), std::string::npos) << all;
}

// --- units and axes

TEST(Characters, one_way_of_placing_files_for_hair_and_meshes) {
    const Scratch scratch;
    const Mesh ball = triangulated(Sphere{0.1}, 24);
    const Quatd turn = rotation_of({10, 20, 30});
    const Vec3d offset{0.2, 1.5, -0.1};
    // In centimetres, z up, half as large, turned back and moved back.
    const auto into_file = [&](const Vec3d& x) {
        const Vec3d y = 100.0 * (1 / 0.5) * rotate(conjugate(turn), x - offset);
        return Vec3d{y.x, -y.z, y.y};
    };
    Mesh foreign = ball;
    for (auto& v : foreign.vertices) v = cast<float>(into_file(cast<double>(v)));
    StrandPoints points;
    for (const auto& s : on_top())
        points.push_back({into_file(s.root), into_file(s.root + 0.1 * s.direction)});
    write_strands(scratch.path("hair.data"), points, true);
    const std::string placed =
        "units = \"cm\"\nup = \"z\"\nrotation = [10, 20, 30]\nscale = 0.5\noffset = [0.2, 1.5, -0.1]\n";
    const Scene scene =
        scene_of("[groom]\nfile = \"" + scratch.path("hair.data") + "\"\nparticles = 6\n" + placed +
                 "[stretch]\n[[solid]]\nshape = \"mesh\"\nspacing = 0.02\nfile = \"" +
                 scratch.file("ball.obj", obj_of(foreign)) + "\"\n" + placed);
    const auto& level_set = *std::get<std::shared_ptr<const LevelSet>>(scene.solids[0].shape);
    for (size_t v = 0; v < ball.vertices.size(); ++v)
        EXPECT_LT(norm(level_set.mesh().vertices[v] - ball.vertices[v]), 1e-6f);
    for (int s = 0; s < scene.groom.rest.count; ++s)
        EXPECT_LT(norm(cast<double>(scene.groom.rest.at(s, 0)) -
                       on_top()[size_t(scene.groom.origin[size_t(s)].number)].root),
                  1e-6);
}

TEST(Characters, the_unit_of_a_head_is_guessed_from_the_roots_and_said) {
    const Scratch scratch;
    Mesh head = triangulated(Sphere{0.1}, 24);
    for (auto& v : head.vertices) v = 100.f * v;
    const std::string
        file = scratch.file("head.obj", obj_of(head)),
        groom = standing(scratch, on_top(), 0.1, 6, "head") + "[stretch]\n",
        solid =
            "[[solid]]\nname = \"head\"\nshape = \"mesh\"\nspacing = 0.02\nattached = \"head\"\nfile = \"" +
            file + "\"\n";
    const std::string said = said_by([&] {
        const Scene scene = scene_of(groom + solid);
        const Bounds box =
            bounding_box(std::get<std::shared_ptr<const LevelSet>>(scene.solids[0].shape)->mesh());
        EXPECT_NEAR(box.high.y, 0.1, 1e-6);
    });
    for (const char* part : {"guessed cm", "units = \"cm\"", "head.obj"})
        EXPECT_NE(said.find(part), std::string::npos) << said;
    EXPECT_EQ(said_by([&] { scene_of(groom + solid + "units = \"cm\"\n"); }).find("guessed"),
              std::string::npos);
}

// --- meshes as people have them

TEST(Characters, a_head_with_doubled_and_turned_faces_has_an_inside) {
    const Mesh ball = triangulated(Sphere{0.1}, 24);
    Mesh doubled = ball;
    for (const auto& t : ball.triangles) doubled.triangles.push_back({t[0], t[2], t[1]});
    Mesh mixed = ball;
    for (size_t t = 0; t < mixed.triangles.size(); t += 3)
        std::swap(mixed.triangles[t][0], mixed.triangles[t][1]);
    // An eye within, turned inward, of vertices of its own.
    Mesh with_eye = ball;
    for (const auto& v : triangulated(Sphere{0.03}, 12).vertices) with_eye.vertices.push_back(v);
    for (const auto& t : triangulated(Sphere{0.03}, 12).triangles) {
        const int first = int(ball.vertices.size());
        with_eye.triangles.push_back({first + t[0], first + t[2], first + t[1]});
    }
    for (const Mesh& mesh : {doubled, mixed, with_eye}) {
        Winding winding;
        const MeshDistance mended(consistently_wound(mesh, &winding));
        EXPECT_TRUE(winding.changed());
        for (const Vec3d& x : {Vec3d{0, 0, 0}, Vec3d{0.06, 0.03, 0}, Vec3d{0, -0.09, 0.01}})
            EXPECT_TRUE(mended.inside(x));
        EXPECT_FALSE(mended.inside({0.11, 0, 0}));
    }
    Winding winding;
    EXPECT_EQ(consistently_wound(ball, &winding).triangles, ball.triangles);
    EXPECT_FALSE(winding.changed());
    EXPECT_LT(share_without_sides(ball, 1e-3), 1e-9);
    // A neck that is open, and a sheet.
    Mesh open{ball.vertices, {}};
    for (const auto& t : ball.triangles)
        if (ball.vertices[size_t(t[0])].y > -0.06f) open.triangles.push_back(t);
    EXPECT_LT(share_without_sides(open, 1e-3), 0.05);
    const Mesh sheet{{{0, 0, 0}, {0.1f, 0, 0}, {0, 0, 0.1f}, {0.1f, 0.02f, 0.1f}}, {{0, 1, 2}, {1, 3, 2}}};
    EXPECT_GT(share_without_sides(sheet, 1e-3), 0.9);
}

}  // namespace
}  // namespace wetcurl
