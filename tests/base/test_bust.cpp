// The bust: a closed surface of the size that it says, and a hairline that leaves the face free.
#include "base/geometry/bust.h"
#include "base/geometry/level_set.h"
#include "scratch.h"

namespace wetcurl {
namespace {

using testing::expect_error;

double volume(const Mesh& mesh) {
    double sum = 0;
    for (const auto& t : mesh.triangles) {
        const Vec3d a = cast<double>(mesh.vertices[size_t(t[0])]),
                    b = cast<double>(mesh.vertices[size_t(t[1])]),
                    c = cast<double>(mesh.vertices[size_t(t[2])]);
        sum += dot(a, cross(b, c)) / 6;
    }
    return sum;
}

TEST(Bust, is_closed_with_its_triangles_outward_and_its_vertices_on_the_surface) {
    const Mesh mesh = bust_mesh();
    EXPECT_EQ(boundary_edges(mesh), 0);
    // A head has about 4 litres, neck and shoulders more.
    EXPECT_GT(volume(mesh), 0.006);
    EXPECT_LT(volume(mesh), 0.025);
    for (const auto& x : mesh.vertices) ASSERT_LT(std::abs(bust_at(cast<double>(x))), 1e-4);
}

TEST(Bust, is_the_same_on_both_sides_and_grows_with_its_radius) {
    for (const Vec3d& x : {Vec3d{0.03, 0.05, 0.1}, Vec3d{0.1, -0.02, 0.0}, Vec3d{0.15, -0.25, 0.02}}) {
        EXPECT_DOUBLE_EQ(bust_at(x), bust_at({-x.x, x.y, x.z}));
        EXPECT_NEAR(bust_at(2.0 * x, 0.19), 2 * bust_at(x), 1e-15);
    }
    const Bounds small = bounding_box(bust_mesh(0.095)), large = bounding_box(bust_mesh(0.19, 0.007));
    EXPECT_NEAR(large.high.y, 2 * small.high.y, 1e-4);
    // Skull of about 19 by 15 cm, shoulders of about 43.
    EXPECT_NEAR(small.high.y, 0.096, 0.003);
    EXPECT_NEAR(small.high.x, 0.215, 0.02);
    expect_error([] { bust_mesh(0); }, {"above 0"});
    expect_error([] { bust_mesh(0.095, 1e-6); }, {"too fine"});
}

// As a level set: the distance inside the skull is that to its nearest wall.
TEST(Bust, its_level_set_has_the_distance_of_its_surface) {
    const LevelSet level_set(bust_mesh());
    const MeshDistance exact(level_set.mesh());
    for (const Vec3d& x : {Vec3d{0, 0, 0}, Vec3d{0.02, 0.03, 0.15}, Vec3d{0, -0.25, 0.2}, Vec3d{0.2, 0, 0}}) {
        const double d = exact.closest(x).distance * (exact.inside(x) ? -1 : 1);
        EXPECT_NEAR(sample(level_set.grid(), x).phi, d, 2e-3);  // a third of a cell, of 5 mm
        EXPECT_EQ(d < 0, bust_at(x) < 0);
    }
}

TEST(Bust, hair_grows_on_crown_sides_and_nape_and_not_in_the_face) {
    auto grows = [](Vec3d direction) {
        direction = normalized(direction, direction);
        return std::acos(direction.y) < hairline(direction);
    };
    EXPECT_TRUE(grows({0, 1, 0}));
    EXPECT_TRUE(grows({0, 0, -1}));
    EXPECT_TRUE(grows({0, -0.5, -1}));    // nape
    EXPECT_TRUE(grows({1, 0.3, 0}));      // over the ear
    EXPECT_FALSE(grows({1, -0.3, 0}));    // ear
    EXPECT_FALSE(grows({0, 0.2, 1}));     // forehead
    EXPECT_FALSE(grows({0.5, -0.5, 1}));  // cheek
    EXPECT_FALSE(grows({0, -1, -0.5}));   // neck
    // Without a step.
    for (double a = 0; a < 3.14; a += 0.001)
        EXPECT_LT(std::abs(hairline({std::sin(a), 0, std::cos(a)}) -
                           hairline({std::sin(a + 0.001), 0, std::cos(a + 0.001)})),
                  0.004);
}

}  // namespace
}  // namespace wetcurl
