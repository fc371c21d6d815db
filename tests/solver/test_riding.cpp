// Roots that ride on a mesh that deforms: against rigid heads, and against formulas of how the mesh moves.
#include "tests/solver/characters.h"

namespace wetcurl {
namespace {

using namespace testing;

const std::string free_fall = "[integrator]\nsubsteps = 6\ngravity = [0, 0, 0]\n";
const std::string springs = "[stretch]\n[bend]\n[core]\n[stiffness]\nglobal = 2\n";

// Strands that stand out from a ball of 0.1 m.
std::vector<StandingStrand> on_ball() {
    std::vector<StandingStrand> out;
    for (int k = 0; k < 23; ++k) {
        const double y = 0.9 - 0.07 * k, r = std::sqrt(1 - y * y), turn = 2.4 * k;
        const Vec3d n{r * std::cos(turn), y, r * std::sin(turn)};
        out.push_back({0.1005 * n, n});
    }
    return out;
}

// Without contact: level sets of rigid meshes and of those that deform round differently.
Strands apart_from_solids(Scene scene, int frames) {
    scene.solids.clear();
    return after(scene, frames, "double").positions;
}

TEST(Riding, a_mesh_that_moves_rigidly_is_a_rigid_head) {
    const Scratch scratch;
    const Mesh ball = triangulated(Sphere{0.1}, 48);
    const std::string groom = standing(scratch, on_ball(), 0.15, 20, "head"), rest = free_fall + springs;
    const std::string solid =
        "[[solid]]\nname = \"head\"\nshape = \"mesh\"\nspacing = 0.02\nattached = \"head\"\n";
    const std::string file = scratch.file("ball.obj", obj_of(ball));
    const Warp stays = [](const Vec3d& x, double) { return x; };
    const std::string swing =
        "[motion]\naxis = [0.6, 0.8, 0]\nangle = 50\nperiod = 0.9\npivot = [0, -0.2, 0]\n";
    const Scene rigid = scene_of(groom + rest + swing + solid + "file = \"" + file + "\"\n"),
                turned = scene_of(groom + rest + swing + solid + mesh_keyframes(scratch, ball, stays, 1, 2));
    EXPECT_FALSE(rigid.riding);
    ASSERT_TRUE(turned.riding);
    const Strands wanted = apart_from_solids(rigid, 20);
    ASSERT_GT(farthest(wanted, rigid.groom.rest), 0.02);
    EXPECT_LT(farthest(apart_from_solids(turned, 20), wanted), 1e-6);

    // Vertices take the very spline that keyframes of the head take.
    const Scratch more;
    std::string keys;
    const double ways[] = {0, 0.05, 0.2, 0.2, -0.1, 0.3};
    for (int k = 0; k < 6; ++k)
        keys += "[[motion.keyframe]]\ntime = " + std::to_string(0.2 * k) + "\ntranslation = [" +
                std::to_string(ways[k]) + ", 0, " + std::to_string(0.1 * k) + "]\n";
    const Warp carried = [&](const Vec3d& x, double time) {
        const long k = std::lround(time / 0.2);
        return x + Vec3d{ways[k], 0, 0.1 * double(k)};
    };
    const Scene led = scene_of(groom + rest + "[motion]\n" + keys + solid + "file = \"" + file + "\"\n"),
                rides = scene_of(groom + rest + solid + mesh_keyframes(more, ball, carried, 5, 6));
    const Strands there = apart_from_solids(led, 20);
    ASSERT_GT(farthest(there, led.groom.rest), 0.05);
    EXPECT_LT(farthest(apart_from_solids(rides, 20), there), 1e-6);
    for (double time : {0.1, 0.37, 1.1})
        EXPECT_LT(norm(rides.head_at(time)({0.1, 0.2, 0}) - led.head_at(time)({0.1, 0.2, 0})), 1e-7);
}

// A rigid mesh with a motion of its own is the head, to the bit.
TEST(Riding, the_rigid_solid_that_hair_grows_on_is_the_head) {
    const Scratch scratch;
    const std::string file = scratch.file("ball.obj", obj_of(triangulated(Sphere{0.1}, 48)));
    const std::string groom = standing(scratch, on_ball(), 0.15, 12, "head"), rest = free_fall + springs,
                      swing = "axis = [0, 1, 0]\nangle = 40\nperiod = 0.8\n",
                      solid = "[[solid]]\nname = \"head\"\nshape = \"mesh\"\nspacing = 0.01\nfile = \"" +
                              file + "\"\n";
    const Strands of_head =
        after(scene_of(groom + rest + "[motion]\n" + swing + solid + "attached = \"head\"\n"), 6).positions;
    ASSERT_GT(farthest(of_head, scene_of(groom + rest + solid).groom.rest), 0.01);
    EXPECT_EQ(
        farthest(after(scene_of(groom + rest + solid + "[solid.motion]\n" + swing), 6).positions, of_head),
        0);
}

// A body that twists by 1.2 rad each way and bends into a circle's arc, at 24 keyframes a second.
Vec3d twisted_and_bent(const Vec3d& x, double time) {
    const double beat = std::sin(2 * std::numbers::pi * time / 2), twist = 1.2 * beat * x.y / 0.4,
                 c = std::cos(twist), s = std::sin(twist);
    const Vec3d t{c * x.x + s * x.z, x.y, c * x.z - s * x.x};
    const double bend = 1.5 * std::sin(2 * std::numbers::pi * time / 3);  // [1/m] curvature
    if (std::abs(bend) < 1e-9) return t;
    const double angle = bend * t.y, r = 1 / bend - t.x;
    return {1 / bend - r * std::cos(angle), r * std::sin(angle), t.z};
}

TEST(Riding, roots_stay_on_the_skin_of_a_body_that_twists_and_bends) {
    const Scratch scratch;
    const Tube tube;
    const double height = 5e-4;
    std::vector<StandingStrand> strands;
    std::vector<Vec3d> skin, side;
    for (int k = 0; k < 60; ++k) {
        const double turn = 2.399 * k, y = -0.28 + 0.56 * k / 59;
        const Vec3d n{std::cos(turn), 0, std::sin(turn)};
        skin.push_back(Vec3d{0, y, 0} + tube.radius * n), side.push_back(n);
        strands.push_back({skin.back() + height * n, n});
    }
    const Scene scene =
        scene_of(standing(scratch, strands, 0.12, 16, "body") + "[integrator]\nsubsteps = 6\n" +
                 "[stretch]\n[bend]\nstiffness = 2e-4\n[stiffness]\nglobal = 3\n[[solid]]\nname = "
                 "\"body\"\nshape = \"mesh\"\nspacing = 0.008\n" +
                 mesh_keyframes(scratch, tube.mesh(), twisted_and_bent, 24, 97));
    const auto simulation = make_simulation(scene, "float");
    const Mesh rest = tube.mesh();
    double farthest = 0, deepest = 0, stretched = 0, moved = 0, nearest = 1;
    for (int f = 1; f <= 96; ++f) {
        simulation->advance();
        RunFrame frame;
        simulation->snapshot(frame);
        const double time = f / 24.0;
        const MeshDistance body(warped(rest, twisted_and_bent, time));
        for (int s = 0; s < frame.positions.count; ++s) {
            const auto at = [&](int i) { return cast<double>(frame.positions.at(s, i)); };
            // Straight out of the skin there: across two tangents of the deformed surface.
            const size_t number = size_t(scene.groom.origin[size_t(s)].number);
            const Vec3d x = skin[number], n = side[number];
            const double d = 1e-5;
            const auto along = [&](const Vec3d& t) {
                return twisted_and_bent(x + d * t, time) - twisted_and_bent(x - d * t, time);
            };
            const Vec3d up = along({0, 1, 0}), round = along(cross(n, Vec3d{0, 1, 0})),
                        out = normalized(cross(up, round), n), here = twisted_and_bent(x, time);
            const Vec3d outward = dot(out, along(n)) < 0 ? -out : out;
            farthest = std::max(farthest, norm(at(0) - (here + height * outward)));
            moved = std::max(moved, norm(here - x));
            stretched = std::max(stretched, std::abs(norm(at(1) - at(0)) / (0.12 / 15) - 1));
            for (int i = 2; i < frame.positions.particles; ++i) {
                const auto near = body.closest(at(i));
                if (i > 8) nearest = std::min(nearest, near.distance);
                if (body.inside(at(i))) deepest = std::max(deepest, near.distance);
            }
        }
    }
    std::printf(
        "a body that twists and bends for 96 frames: roots at most %.3g mm from their place, hair at "
        "most %.3g mm in it\n",
        1000 * farthest, 1000 * deepest);
    EXPECT_GT(moved, 0.1);
    // Facets of 128 corners lie up to 0.03 mm inside the tube.
    EXPECT_LT(farthest, 1e-4);
    EXPECT_LT(stretched, 1e-4);
    EXPECT_LT(nearest, 2e-3);  // hair lies on it
    EXPECT_LT(deepest, 2e-3);
}

TEST(Riding, at_constant_velocity_hair_rests_in_the_moving_frame) {
    const Scratch scratch;
    const Vec3d velocity{1.5, 0, 0.4};
    const Warp carried = [&](const Vec3d& x, double time) { return x + time * velocity; };
    const Mesh ball = triangulated(Sphere{0.1}, 48);
    const std::string text =
        standing(scratch, on_ball(), 0.15, 20, "head") + free_fall +
        "[stretch]\n[bend]\nstiffness = 2\n[core]\n[stiffness]\nglobal = 20\n[[solid]]\nname = \"head\"\n"
        "shape = \"mesh\"\n" +
        mesh_keyframes(scratch, ball, carried, 8, 25);
    Scene scene = scene_of(text);
    scene.solids.clear();
    const auto simulation = make_simulation(scene, "double");
    for (int f = 0; f < 48; ++f) simulation->advance();
    // It was drawn along from rest 2 s ago; drag against the world would bend it for good.
    const auto x = simulation->state().x, v = simulation->state().v;
    double off = 0, slip = 0;
    for (size_t k = 0; k < x.size(); ++k) {
        off = std::max(off, norm(x[k] - cast<double>(scene.groom.rest.points[k]) - 2.0 * velocity));
        slip = std::max(slip, norm(v[k] - velocity));
    }
    EXPECT_LT(off, 1e-5);
    EXPECT_LT(slip, 1e-4);
}

TEST(Riding, roots_move_apart_as_their_mesh_grows_and_edges_keep_their_length) {
    const Scratch scratch;
    const Warp grows = [](const Vec3d& x, double time) { return (1 + time) * x; };
    const Mesh ball = triangulated(Sphere{0.1}, 48);
    const Scene scene = scene_of(standing(scratch, on_ball(), 0.15, 20, "head") + free_fall + springs +
                                 "[[solid]]\nname = \"head\"\nshape = \"mesh\"\n" +
                                 mesh_keyframes(scratch, ball, grows, 4, 5));
    RidingRoots::Room room;
    for (double time : {0.0, 0.25, 0.6, 1.0}) {
        scene.root_poses_at(time, room);
        for (int s = 0; s < scene.groom.rest.count; ++s) {
            const Vec3d root = cast<double>(scene.groom.rest.at(s, 0)),
                        next = cast<double>(scene.groom.rest.at(s, 1));
            const Pose& pose = room.pose[size_t(s)];
            EXPECT_LT(norm(pose(root) - (1 + time) * root), 1e-6) << time;
            EXPECT_LT(norm(pose(next) - pose(root) - (next - root)), 1e-6) << time;
        }
    }
}

TEST(Riding, a_thinned_groom_has_the_roots_and_the_head_of_the_full_one) {
    const Scratch scratch;
    const std::string text =
        "[groom]\ngrid = [8, 8]\nparticles = 12\nscalp = \"body\"\nscalp_radius = 0.1\n[stretch]\n"
        "[[solid]]\nname = \"body\"\nshape = \"mesh\"\n" +
        mesh_keyframes(scratch, Tube{0.1, 0.1, 48, 40}.mesh(), twisted_and_bent, 8, 9);
    const Scene full = scene_of(text), thin = scene_of(text, {}, 2);
    std::vector<int> kept;
    coarsened(full.groom, 2, &kept);
    RidingRoots::Room of_thin, of_full;
    thin.root_poses_at(0.3, of_thin), full.root_poses_at(0.3, of_full);
    ASSERT_EQ(of_thin.pose.size(), 16u);
    ASSERT_EQ(kept.size(), 16u);
    for (size_t s = 0; s < 16; ++s)
        EXPECT_EQ(norm(of_thin.pose[s].translation - of_full.pose[size_t(kept[s])].translation), 0);
    EXPECT_EQ(norm(full.head_at(0.3).translation - thin.head_at(0.3).translation), 0);
    EXPECT_GT(norm(full.head_at(0.3).translation - full.head_at(0).translation), 1e-4);
}

TEST(Riding, says_what_is_wrong_with_the_name_of_a_scalp) {
    const Scratch scratch;
    const std::string file = scratch.file("ball.obj", obj_of(triangulated(Sphere{0.1}, 16))),
                      mesh = "shape = \"mesh\"\nspacing = 0.05\nfile = \"" + file + "\"\n";
    const auto refuses = [&](const std::string& text, std::initializer_list<std::string> parts) {
        expect_error<Misuse>(
            [&] { scene_of("[stretch]\n[groom]\ngrid = [2, 2]\nscalp = \"head\"\n" + text); }, parts);
    };
    refuses("[[solid]]\nname = \"head\"\n", {"scene.toml:4: groom.scalp", "no mesh"});
    refuses("[[solid]]\nname = \"head\"\n" + mesh + "[[solid]]\nname = \"head\"\n", {"several"});
    refuses("scalp_units = \"cm\"\n[[solid]]\nname = \"head\"\n" + mesh,
            {"scene.toml:5", "[[solid]] 'head'"});
    refuses("[motion]\nangle = 3\nperiod = 1\n[[solid]]\nname = \"head\"\n" + mesh,
            {"scene.toml:4", "[motion]", "attached = \"head\""});
    expect_error<Error>([&] { scene_of("[groom]\nscalp = \"haed\"\n[[solid]]\nname = \"head\"\n" + mesh); },
                        {"haed"});
}

}  // namespace
}  // namespace wetcurl
