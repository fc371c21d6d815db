// What a run warns of: the longest edge, the fastest particle and growing energy, and where they are.
#include "base/frame_watch.h"
#include "scratch.h"

namespace wetcurl {
namespace {

// Two strands of three particles, edges of 1 cm along y.
Groom straight() {
    Groom groom;
    groom.rest = Strands(2, 3);
    for (int s = 0; s < 2; ++s)
        for (int i = 0; i < 3; ++i) groom.rest.at(s, i) = {float(s), -0.01f * float(i), 0};
    return groom;
}

TEST(FrameWatch, finds_the_longest_edge_and_the_first_beyond_three_times) {
    const Groom groom = straight();
    FrameWatch watch(groom, 10);
    EXPECT_FALSE(watch.stretch());
    RunFrame frame;
    frame.positions = groom.rest;
    watch.look(0, frame);
    EXPECT_NEAR(watch.stretch()->value, 1, 1e-5);
    EXPECT_FALSE(watch.overstretched());
    frame.positions.at(1, 2).y = -0.01f - 0.04f;
    watch.look(1, frame);
    frame.positions.at(0, 1).y = -0.06f;
    watch.look(2, frame);
    EXPECT_NEAR(watch.stretch()->value, 6, 1e-4);
    EXPECT_EQ(watch.stretch()->frame, 2);
    EXPECT_EQ(watch.stretch()->strand, 0);
    EXPECT_EQ(watch.stretch()->particle, 0);
    ASSERT_TRUE(watch.overstretched());
    EXPECT_NEAR(watch.overstretched()->value, 4, 1e-4);
    EXPECT_EQ(watch.overstretched()->frame, 1);
    EXPECT_EQ(watch.overstretched()->strand, 1);
    EXPECT_EQ(watch.overstretched()->particle, 1);
}

TEST(FrameWatch, finds_the_fastest_particle_between_frames_that_follow_each_other) {
    const Groom groom = straight();
    FrameWatch watch(groom, 10);
    RunFrame frame;
    frame.positions = groom.rest;
    frame.energy = {1, 2};
    watch.look(0, frame);
    EXPECT_FALSE(watch.speed());
    frame.positions.at(1, 0).x += 0.2f;
    frame.energy = {4, 1};
    watch.look(1, frame);
    EXPECT_NEAR(watch.speed()->value, 2, 1e-5);  // [m/s]
    EXPECT_EQ(watch.speed()->strand, 1);
    EXPECT_EQ(watch.speed()->particle, 0);
    EXPECT_EQ(watch.energy_growth()->value, 2);
    EXPECT_EQ(watch.energy_growth()->frame, 1);
    frame.positions.at(1, 0).x += 2;
    frame.energy = {100, 1};
    watch.look(3, frame);  // frame 2 was left out
    EXPECT_NEAR(watch.speed()->value, 2, 1e-5);
    EXPECT_EQ(watch.energy_growth()->value, 2);
}

TEST(FrameWatch, finds_the_first_frame_beyond_a_hundred_metres_a_second) {
    const Groom groom = straight();
    FrameWatch watch(groom, 10);
    RunFrame frame;
    frame.positions = groom.rest;
    watch.look(0, frame);
    frame.positions.at(1, 1).x += 9.5f;
    watch.look(1, frame);
    EXPECT_FALSE(watch.overspeed());
    frame.positions.at(1, 1).x += 10.5f;
    watch.look(2, frame);
    ASSERT_TRUE(watch.overspeed());
    EXPECT_NEAR(watch.overspeed()->value, 105, 1e-2);
    EXPECT_EQ(watch.overspeed()->frame, 2);
    EXPECT_EQ(watch.overspeed()->strand, 1);
    EXPECT_EQ(watch.overspeed()->particle, 1);
    frame.positions.at(1, 1).x += 20;
    watch.look(3, frame);
    EXPECT_EQ(watch.overspeed()->frame, 2);
    EXPECT_NEAR(watch.speed()->value, 200, 1e-2);
}

TEST(FrameWatch, a_cut_has_no_speed_and_gives_no_energy) {
    const Groom groom = straight();
    FrameWatch watch(groom, 24);
    RunFrame frame;
    frame.positions = groom.rest;
    frame.energy = {1};
    watch.look(0, frame);
    for (Vec3f& x : frame.positions.points) x.z += 5;
    frame.energy = {50};
    watch.look(1, frame);
    EXPECT_FALSE(watch.speed());
    EXPECT_FALSE(watch.energy_growth());
    for (Vec3f& x : frame.positions.points) x.z += 0.5f;  // 12 m/s
    frame.energy = {51};
    watch.look(2, frame);
    EXPECT_NEAR(watch.speed()->value, 12, 1e-4);
    EXPECT_NEAR(watch.energy_growth()->value, 1, 1e-9);
}

TEST(FrameWatch, rounding_does_not_stretch_an_edge_of_no_length) {
    Groom groom = straight();
    groom.rest.at(0, 1) = groom.rest.at(0, 0);
    FrameWatch watch(groom, 10);
    RunFrame frame;
    frame.positions = groom.rest;
    frame.positions.at(0, 1).y -= 1e-6f;
    watch.look(0, frame);
    EXPECT_LT(watch.stretch()->value, 1.01);
}

}  // namespace
}  // namespace wetcurl
