// Pictures judged by what must be seen: where a point lands, what hides what, how colours answer to water.
#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "app/drawing/image_file.h"
#include "app/drawing/picture.h"
#include "base/error.h"

namespace wetcurl {
namespace {

// One straight strand of 20 particles.
Strands line(const Vec3f& from, const Vec3f& to) {
    Strands s(1, 20);
    for (int i = 0; i < 20; ++i) s.at(0, i) = from + (i / 19.f) * (to - from);
    return s;
}

// `count` helices that hang from a disc of 3 cm radius.
Strands curls(int count) {
    Strands s(count, 40);
    for (int k = 0; k < count; ++k)
        for (int i = 0; i < 40; ++i) {
            const float t = i / 39.f, root = 0.03f * std::sqrt((k + 0.5f) / count), around = 2.4f * k,
                        turn = 25 * t + k;
            s.at(k, i) = {root * std::cos(around) + 0.006f * std::cos(turn), -0.12f * t,
                          root * std::sin(around) + 0.006f * std::sin(turn)};
        }
    return s;
}

// A square of `edge` metres that faces +Z, at the given distance along it.
PosedMesh wall(float edge, float z) {
    const float e = edge / 2;
    return {{{{-e, -e, 0}, {e, -e, 0}, {e, e, 0}, {-e, e, 0}}, {{0, 1, 2}, {0, 2, 3}}},
            {Quatd::identity(), {0, 0, z}}};
}

Camera front_camera() { return camera_at({0, 0, 1}, {0, 0, 0}, 20, 160, 160); }

float difference(const float* a, const float* b) {
    return std::max({std::fabs(a[0] - b[0]), std::fabs(a[1] - b[1]), std::fabs(a[2] - b[2])});
}

Image empty_picture() { return draw_panel({}, front_camera()); }

TEST(picture, a_point_lands_at_the_pixel_of_the_pinhole_formula) {
    const Camera camera = camera_at({0, 0, 2}, {0, 0, 0}, 90, 200, 100);
    EXPECT_NEAR(camera.focal, 50, 1e-3);  // half the height over tan 45
    const Vec3f p = camera.project({0.5f, 0.25f, 0});
    EXPECT_NEAR(p.x, 100 + 50 * 0.5 / 2, 1e-3);
    EXPECT_NEAR(p.y, 50 - 50 * 0.25 / 2, 1e-3);
    EXPECT_NEAR(p.z, 2, 1e-6);
}

TEST(picture, a_strand_is_drawn_where_its_points_project) {
    const Strands strand = line({0.04f, 0.05f, 0.02f}, {0.05f, 0.03f, 0.02f});
    const Image with = draw_panel({{{&strand}}, {}}, front_camera()), without = empty_picture();
    double weight = 0, column = 0, row = 0;
    for (int r = 0; r < with.height; ++r)
        for (int c = 0; c < with.width; ++c) {
            const double d = difference(with.pixel(c, r), without.pixel(c, r));
            weight += d, column += d * (c + 0.5), row += d * (r + 0.5);
        }
    ASSERT_GT(weight, 1);
    const Vec3f middle = front_camera().project({0.045f, 0.04f, 0.02f});
    // The tip is thinner than the root, so the centre of what is drawn lies a little towards the root.
    EXPECT_NEAR(column / weight, middle.x, 0.5);
    EXPECT_NEAR(row / weight, middle.y, 0.8);
}

TEST(picture, a_solid_hides_the_strand_behind_it_and_not_the_one_before_it) {
    const Strands before = line({0, 0.08f, 0.05f}, {0, -0.08f, 0.05f}),
                  behind = line({0, 0.08f, -0.05f}, {0, -0.08f, -0.05f});
    const Camera camera = camera_at({0, 0, 0.3f}, {0, 0, 0}, 20, 160, 160);  // strands are wider than a pixel
    const PosedMesh solid = wall(0.2f, 0);
    const Image alone = draw_panel({{}, {solid}}, camera);
    const Image shown = draw_panel({{{&before}}, {solid}}, camera);
    const Image hidden = draw_panel({{{&behind}}, {solid}}, camera);
    const Image open = draw_panel({{{&behind}}, {}}, camera), nothing = draw_panel({}, camera);
    EXPECT_GT(difference(open.pixel(80, 80), nothing.pixel(80, 80)),
              0.1);  // it would be seen without the solid
    EXPECT_GT(difference(shown.pixel(80, 80), alone.pixel(80, 80)), 0.1);
    // What is left is light that the strand keeps from the solid.
    EXPECT_LT(difference(hidden.pixel(80, 80), alone.pixel(80, 80)), 0.02);
}

TEST(picture, of_two_crossing_strands_the_nearer_is_seen_in_either_order) {
    const Strands near = line({0, 0.05f, 0.01f}, {0, -0.05f, 0.01f}),
                  far = line({-0.05f, 0, -0.01f}, {0.05f, 0, -0.01f});
    const StrandLayer red{&near, nullptr, {0.9f, 0.1f, 0.1f}}, blue{&far, nullptr, {0.1f, 0.1f, 0.9f}};
    // Close enough for a strand to be several pixels wide.
    const Camera camera = camera_at({0, 0, 0.1f}, {0, 0, 0}, 20, 160, 160);
    const Image one = draw_panel({{red, blue}, {}}, camera), other = draw_panel({{blue, red}, {}}, camera);
    for (const Image* image : {&one, &other}) {
        const float* p = image->pixel(80, 80);
        EXPECT_GT(p[0], p[2] + 0.1f);
        const float* q = image->pixel(50, 80);  // where only the far one passes
        EXPECT_GT(q[2], q[0] + 0.1f);
    }
}

TEST(picture, a_thin_line_keeps_its_weight_wherever_it_falls_between_pixels) {
    const Image without = empty_picture();
    std::vector<double> weights;
    for (int eighth = 0; eighth < 8; ++eighth) {
        const float pixel = 1 / front_camera().focal, x = pixel * eighth / 8;
        const Strands strand = line({x, 0.05f, 0}, {x, -0.05f, 0});
        const Image with = draw_panel({{{&strand}}, {}}, front_camera());
        double sum = 0;
        for (size_t i = 0; i < with.rgb.size(); ++i) sum += std::fabs(with.rgb[i] - without.rgb[i]);
        weights.push_back(sum);
    }
    const auto [low, high] = std::minmax_element(weights.begin(), weights.end());
    ASSERT_GT(*low, 10);
    // Coverage is linear in light and the sum is taken as displayed: a bent curve, hence not exactly equal.
    EXPECT_LT(*high / *low, 1.25);
}

TEST(picture, the_same_bits_for_any_number_of_threads) {
    const Strands strands = curls(60);
    const std::vector<float> wet(strands.points.size(), 0.6f);
    const Panel panel{{{&strands, &wet}}, {wall(0.1f, -0.02f)}};
    const int before = omp_get_max_threads();
    std::vector<Image> images;
    for (int threads : {1, 2, 3}) {
        omp_set_num_threads(threads);
        images.push_back(draw_panel(panel, front_camera()));
    }
    omp_set_num_threads(before);
    EXPECT_GT(difference(images[0].pixel(80, 85), empty_picture().pixel(80, 85)), 0.05);
    EXPECT_EQ(images[0].rgb, images[1].rgb);
    EXPECT_EQ(images[0].rgb, images[2].rgb);
}

TEST(picture, a_rainbow_goes_from_blue_to_red) {
    const Vec3f dry = rainbow_color(0), half = rainbow_color(0.5f), wet = rainbow_color(1);
    EXPECT_GT(dry.z, dry.x + 0.5f);
    EXPECT_GT(dry.z, dry.y + 0.5f);
    EXPECT_GT(half.y, std::max(half.x, half.z) + 0.5f);
    EXPECT_GT(wet.x, wet.y + 0.5f);
    EXPECT_GT(wet.x, wet.z + 0.5f);
}

TEST(picture, a_strand_shows_the_colour_of_a_number_along_it_where_asked) {
    const Strands strand = line({0, 0.05f, 0}, {0, -0.05f, 0});
    std::vector<float> saturation(20);
    for (int i = 0; i < 20; ++i) saturation[i] = i < 10 ? 1.f : 0.f;  // wet root, dry tip
    const Camera camera = camera_at({0, 0, 0.4f}, {0, 0, 0}, 20, 160, 160);
    const Image image = draw_panel({{{.strands = &strand, .shown = &saturation}}, {}}, camera);
    const float *root = image.pixel(80, 40), *tip = image.pixel(80, 120);
    EXPECT_GT(root[0], root[2] + 0.2f);
    EXPECT_GT(tip[2], tip[0] + 0.2f);
}

// Mean and largest brightness of the pixels that hair covers.
std::pair<double, double> brightness(const Image& image, const Image& background) {
    double sum = 0, largest = 0;
    int covered = 0;
    for (int r = 0; r < image.height; ++r)
        for (int c = 0; c < image.width; ++c) {
            if (difference(image.pixel(c, r), background.pixel(c, r)) < 0.3)
                continue;  // edges are half background
            const float* p = image.pixel(c, r);
            const double y = 0.2126 * p[0] + 0.7152 * p[1] + 0.0722 * p[2];
            sum += y, largest = std::max(largest, y), ++covered;
        }
    EXPECT_GT(covered, 500);
    return {sum / covered, largest};
}

TEST(picture, wet_hair_is_darker_and_shines_more) {
    const Strands strands = curls(80);
    const std::vector<float> full(strands.points.size(), 1.f);
    const Camera camera = camera_at({0, -0.06f, 0.2f}, {0, -0.06f, 0}, 20, 240, 240);
    const Image nothing = draw_panel({}, camera);
    const auto dry = brightness(draw_panel({{{&strands}}, {}}, camera), nothing);
    const auto wet = brightness(draw_panel({{{&strands, &full}}, {}}, camera), nothing);
    EXPECT_LT(wet.first, 0.9 * dry.first);
    EXPECT_GT(wet.second / wet.first, 1.1 * dry.second / dry.first);
}

TEST(picture, hair_under_other_hair_lies_in_its_shadow) {
    // The same curls alone, and below a dense roof that the camera does not see.
    const Strands strands = curls(40);
    Strands roof(1600, 20);
    for (int k = 0; k < 1600; ++k)
        for (int i = 0; i < 20; ++i) roof.at(k, i) = {-0.4f + 0.6f * i / 19, 0.15f, -0.4f + 0.8f * k / 1599};
    const Camera camera = camera_at({0, -0.06f, 0.2f}, {0, -0.06f, 0}, 20, 240, 240);
    const Image nothing = draw_panel({}, camera);
    const auto lit = brightness(draw_panel({{{&strands}}, {}}, camera), nothing);
    const auto shaded = brightness(draw_panel({{{&strands}, {&roof}}, {}}, camera), nothing);
    EXPECT_LT(shaded.first, 0.9 * lit.first);
}

TEST(picture, a_camera_that_follows_sees_what_moves_as_if_it_stood) {
    const Camera camera = camera_at({0.4f, 0.2f, 1}, {0, 0, 0}, 30, 300, 400);
    const Pose from{rotation_about({0, 1, 0}, 0.4), {0.1, 0, 0}},
        to{rotation_about({0, 0.6, 0.8}, 1.1), {0, 0.3, -0.2}};
    const Camera moved = carried(camera, from, to);
    for (const Vec3d& x : {Vec3d{0, 0, 0}, {0.1, 0, 0}, {0, -0.1, 0.05}, {0.02, 0.1, -0.1}})
        EXPECT_LT(norm(moved.project(cast<float>(to(x))) - camera.project(cast<float>(from(x)))), 2e-3f);
}

TEST(picture, the_fitted_camera_sees_all_hair_large_and_minds_no_floor) {
    const Strands strands = curls(50);
    Extent extent;
    extent.add(strands);
    PosedMesh floor = wall(20, 0);
    floor.pose.rotation = rotation_about({1, 0, 0}, -std::numbers::pi / 2);
    extent.add(floor);
    for (double yaw : {0.0, 30.0, 200.0}) {
        const Camera camera = fitted_camera(extent, {.yaw = yaw}, 300, 400);
        float left = 1e9f, right = -1e9f, top = 1e9f, bottom = -1e9f;
        for (const Vec3f& x : strands.points) {
            const Vec3f p = camera.project(x);
            left = std::min(left, p.x), right = std::max(right, p.x), top = std::min(top, p.y),
            bottom = std::max(bottom, p.y);
        }
        EXPECT_GT(left, 0);
        EXPECT_LT(right, 300);
        EXPECT_GT(top, 0);
        EXPECT_LT(bottom, 0.95 * 400);  // the label stands below
        EXPECT_TRUE(bottom - top > 0.8 * 400 || right - left > 0.8 * 300);
    }
}

TEST(picture, a_floor_that_passes_under_the_eye_is_cut_and_drawn) {
    PosedMesh floor = wall(20, 0);
    floor.pose = {rotation_about({1, 0, 0}, -std::numbers::pi / 2), {0, -0.1, 0}};
    const Image image = draw_panel({{}, {floor}}, front_camera()), nothing = empty_picture();
    EXPECT_GT(difference(image.pixel(80, 155), nothing.pixel(80, 155)), 0.02);
    EXPECT_EQ(difference(image.pixel(80, 40), nothing.pixel(80, 40)), 0);  // sky above the horizon
}

TEST(picture, positions_that_are_not_finite_are_refused) {
    Strands strands = curls(3);
    strands.at(1, 5).y = NAN;
    EXPECT_THROW(draw_panel({{{&strands}}, {}}, front_camera()), Error);
}

TEST(picture, panels_stand_side_by_side) {
    Image a(3, 2), b(2, 2);
    a.pixel(2, 1)[0] = 0.5f;
    b.pixel(0, 1)[2] = 0.25f;
    const Image both = side_by_side({a, b});
    ASSERT_EQ(both.width, 5);
    ASSERT_EQ(both.height, 2);
    EXPECT_EQ(both.pixel(2, 1)[0], 0.5f);
    EXPECT_EQ(both.pixel(3, 1)[2], 0.25f);
}

TEST(picture, a_png_has_its_signature_and_size) {
    const auto path = std::filesystem::temp_directory_path() / "wetcurl_test_picture" / "image.png";
    try {
        write_png(path.string(), Image(7, 5), true);
    } catch (const Error& e) {
        if (std::string(e.what()).find("OpenCV") != std::string::npos)
            GTEST_SKIP() << "SKIP: built without OpenCV";
        throw;
    }
    std::ifstream file(path, std::ios::binary);
    std::vector<char> head(24);
    file.read(head.data(), 24);
    ASSERT_TRUE(file);
    EXPECT_EQ(std::string(head.data() + 1, 3), "PNG");
    EXPECT_EQ(int(head[19]), 7);  // width and height, big-endian, in the first chunk
    EXPECT_EQ(int(head[23]), 5);
    std::filesystem::remove_all(path.parent_path());
}

}  // namespace
}  // namespace wetcurl
