// Prescribed motion: through its keys, without jumps of place or velocity.
#include <cmath>

#include "solver/motion/motion.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

using namespace testing;

Motion motion_of(const std::string& text) {
    Config config = Config::parse("[motion]\n" + text, "scene.toml");
    Motion motion(config.root().table("motion"));
    config.require_all_used();
    return motion;
}

const char* keys =
    "[[motion.keyframe]]\ntime = 0.5\nrotation = [0, 30, 0]\ntranslation = [0.1, 0, 0]\n"
    "[[motion.keyframe]]\ntime = 1.0\nrotation = [10, 80, -20]\ntranslation = [0.3, 0.2, 0]\n"
    "[[motion.keyframe]]\ntime = 2.0\nrotation = [0, -40, 0]\ntranslation = [0.2, 0.5, -0.4]\n";

const Vec3d body{0.1, 0.2, -0.05};  // a point that is carried along

Vec3d velocity(const Motion& m, double t, double d) { return (1 / d) * (m.at(t + d)(body) - m.at(t)(body)); }

// Velocity may jump nowhere: left and right differences close in on each other with the step.
void expect_c1(const Motion& m, double until) {
    double fastest = 0;
    for (double t = 0; t < until; t += 0.0625) {
        const double d = 1e-5;
        fastest = std::max(fastest, norm(velocity(m, t, d)));
        const Vec3d jump = velocity(m, t, d) - velocity(m, t, -d);
        EXPECT_LT(norm(jump), 1e-2) << "at " << t;
    }
    EXPECT_GT(fastest, 0.1);
}

TEST(Motion, at_rest_is_the_identity) {
    const Motion none = motion_of("");
    EXPECT_FALSE(none.moves());
    EXPECT_EQ(norm(none.at(3)(body) - body), 0);
}

TEST(Motion, passes_through_its_keys_and_rests_outside_them) {
    const Motion m = motion_of(keys);
    EXPECT_TRUE(m.moves());
    const double degree = std::acos(-1) / 180;
    const Vec3d turn = degree * Vec3d{10, 80, -20};
    EXPECT_LT(norm(m.at(1)(body) -
                   (rotate(rotation_about((1 / norm(turn)) * turn, norm(turn)), body) + Vec3d{0.3, 0.2, 0})),
              1e-14);
    EXPECT_LT(norm(m.at(0.5)(body) - m.at(0)(body)), 1e-14);
    EXPECT_LT(norm(m.at(2)(body) - m.at(9)(body)), 1e-14);
    EXPECT_LT(norm(m.at(2).translation - Vec3d{0.2, 0.5, -0.4}), 1e-14);
}

TEST(Motion, velocity_does_not_jump_at_keys_or_where_an_oscillation_begins) {
    expect_c1(motion_of(keys), 2.5);
    expect_c1(motion_of("axis = [0, 1, 0]\nangle = 60\nshift = [0.1, 0, 0]\nperiod = 0.8\nstart = "
                        "0.25\npivot = [0, 0.1, 0]\n"),
              2.5);
}

TEST(Motion, the_c1_check_sees_a_jump) {
    const Motion m = motion_of(keys);
    // Between keys 0.5 and 1 the mean velocity is not zero: a motion by straight lines would jump at 0.5.
    EXPECT_GT(norm(2 * (m.at(1)(body) - m.at(0.5)(body))), 0.2);
}

TEST(Motion, stays_between_its_keys) {
    const Motion m = motion_of(keys);
    for (double t = 0; t < 3; t += 0.01) {
        const Vec3d x = m.at(t).translation;
        EXPECT_GE(x.x, 0.1 - 1e-12);
        EXPECT_LE(x.x, 0.3 + 1e-12);
        EXPECT_GE(x.y, -1e-12);
        EXPECT_LE(x.y, 0.5 + 1e-12);
    }
}

TEST(Motion, turns_about_its_pivot) {
    const Motion m = motion_of("axis = [0, 0, 1]\nangle = 90\nperiod = 1\npivot = [0.3, 0.1, 0]\n");
    for (double t : {0.3, 0.7, 1.25})
        EXPECT_LT(norm(m.at(t)(Vec3d{0.3, 0.1, 0}) - Vec3d{0.3, 0.1, 0}), 1e-14);
    // A quarter of a period after the easing is over: the whole angle.
    const Vec3d turned = m.at(1.25)(Vec3d{1.3, 0.1, 0});
    EXPECT_LT(norm(turned - Vec3d{0.3, 1.1, 0}), 1e-12);
}

TEST(Motion, is_read_from_a_file_of_transforms) {
    const Scratch folder;
    folder.file("head.txt", "# time rx ry rz tx ty tz\n0 0 0 0 0 0 0\n1 0 90 0 0.5 0 0\n");
    Config config = Config::parse("[motion]\nfile = \"head.txt\"\n", "scene.toml", folder.path());
    const Motion m(config.root().table("motion"));
    EXPECT_LT(norm(m.at(1)(Vec3d{0, 0, 1}) - Vec3d{1.5, 0, 0}), 1e-14);
}

TEST(Motion, wrong_values_say_where_and_what_is_allowed) {
    expect_error<Misuse>([] { motion_of("axis = [0, 0, 0]\n"); }, {"scene.toml:2", "axis", "zero"});
    expect_error<Misuse>([] { motion_of("angle = 20\n"); }, {"period"});
    expect_error<Misuse>([] { motion_of("[[motion.keyframe]]\ntime = 1\n[[motion.keyframe]]\ntime = 1\n"); },
                         {"times must grow"});
    expect_error<Misuse>([] { motion_of("file = \"nowhere.txt\"\n"); }, {"scene.toml:2", "nowhere.txt"});
    const Scratch folder;
    folder.file("bad.txt", "0 0 0 0 0 0 0\n1 0 x 0 0 0 0\n");
    Config config = Config::parse("[motion]\nfile = \"bad.txt\"\n", "scene.toml", folder.path());
    expect_error<Misuse>([&] { Motion(config.root().table("motion")); }, {"bad.txt:2", "time rx ry rz"});
}

}  // namespace
}  // namespace wetcurl
