// Level sets of moving meshes against analytic spheres: distance, velocity, bits for any number of threads.
#include <cstring>

#include "base/geometry/shapes.h"
#include "scratch.h"
#include "tests/base/threads.h"

namespace wetcurl {
namespace {

using testing::Random;
using testing::with_one_and_three_threads;

constexpr double radius = 0.1, growth = 0.3, seconds = 1.0 / 24;  // [m], [m/s], [s]

std::vector<Vec3f> scaled(const Mesh& mesh, double by) {
    auto vertices = mesh.vertices;
    for (auto& v : vertices) v = float(by) * v;
    return vertices;
}

// A sphere that grows from `radius`, on a grid that holds it at both ends.
struct GrowingSphere {
    Mesh mesh = triangulated(Sphere{radius}, 256);  // sagitta 8e-6 m, far under the grid's error
    double end = radius + growth * seconds;
    MovingLevelSet level_set;
    explicit GrowingSphere(double spacing)
        : level_set(mesh, {{-end, -end, -end}, {end, end, end}}, spacing, 0) {
        level_set.advance(scaled(mesh, end / radius), seconds);
    }
};

TEST(MovingLevelSet, of_a_growing_sphere_is_the_distance_at_every_time_between) {
    const double h = 0.005;
    const GrowingSphere sphere(h);
    Random random(1);
    double near = 0, far = 0;
    for (double share : {0.0, 0.3, 0.7, 1.0}) {
        const MovingGrid grid = sphere.level_set.grid(share);
        const double r = radius + share * growth * seconds;
        for (int k = 0; k < 5000; ++k) {
            const double from_surface = random.number(-0.09, 0.02);
            const Vec3d x = (r + from_surface) * random.direction();
            double& worst = std::abs(from_surface) < 0.25 * h ? near : far;
            worst = std::max(worst, std::abs(sample(grid, x).phi - from_surface));
        }
    }
    std::printf("moving level set of a sphere, spacing %g mm: error %.3g mm in the band, %.3g mm beyond\n",
                1000 * h, 1000 * near, 1000 * far);
    EXPECT_GT(near, 1e-6);
    // Trilinear interpolation of |x| on a grid, h²/8 of its two curvatures 1/r, and the facets.
    EXPECT_LT(near, h * h / (4 * (radius - 2 * h)) + 1.6e-5);
    // Near the centre, where the distance bends: half a diagonal of the coarsest lattice.
    EXPECT_LT(far, 0.87 * 8 * h);
}

TEST(MovingLevelSet, surface_of_a_growing_sphere_moves_along_its_normal) {
    const GrowingSphere sphere(0.005);
    const MovingGrid grid = sphere.level_set.grid(0.5);
    Random random(2);
    for (int k = 0; k < 2000; ++k) {
        const Vec3d n = random.direction(), x = (radius + random.number(0, 0.012)) * n;
        const Vec3d u = surface_velocity(grid, x);
        // The normal of a trilinear interpolant is off by h / r.
        EXPECT_LT(norm(u - growth * n), 0.05 * growth);
    }
}

TEST(MovingLevelSet, surface_of_a_turning_sphere_moves_across_its_normal) {
    const Mesh mesh = triangulated(Sphere{radius}, 128);
    MovingLevelSet level_set(mesh, bounding_box(mesh), 0.005, 0);
    const double spin = 2;  // [rad/s]
    auto vertices = mesh.vertices;
    for (auto& v : vertices)
        v = cast<float>(rotate(rotation_about({0, 1, 0}, spin * seconds), cast<double>(v)));
    level_set.advance(vertices, seconds);
    const MovingGrid grid = level_set.grid(1);
    Random random(3);
    for (int k = 0; k < 2000; ++k) {
        const Vec3d x = radius * random.direction();
        // Chords of the turn, a quarter of its angle squared; facets and cells by as much again.
        EXPECT_LT(norm(surface_velocity(grid, x) - cross(Vec3d{0, spin, 0}, x)), 0.05 * spin * radius);
    }
    EXPECT_GT(norm(surface_velocity(grid, Vec3d{radius, 0, 0})), 0.9 * spin * radius);
}

TEST(MovingLevelSet, in_its_band_holds_the_distances_of_one_that_is_exact_everywhere) {
    // Parts of different widths, and one that lies between the nodes of the coarsest lattice.
    Mesh mesh = triangulated(Box{{0.1, 0.05, 0.08}});
    const Mesh spike = triangulated(Capsule{0.03, 0.004}, 16);
    for (auto t : spike.triangles) {
        for (int& corner : t) corner += int(mesh.vertices.size());
        mesh.triangles.push_back(t);
    }
    for (const auto& v : spike.vertices) mesh.vertices.push_back(v + Vec3f{0.03f, 0.085f, 0.01f});
    const double h = 0.0043, band = h;
    const MovingLevelSet level_set(mesh, bounding_box(mesh), h, band);
    const MeshDistance exact(mesh);
    const MovingGrid g = level_set.grid(1);
    int in_band = 0;
    for (int k = 0; k < g.nz; ++k)
        for (int j = 0; j < g.ny; ++j)
            for (int i = 0; i < g.nx; ++i) {
                const Vec3d x =
                    cast<double>(g.origin) + double(g.spacing) * Vec3d{double(i), double(j), double(k)};
                const double d = exact.closest(x).distance;
                const float phi = g.at((size_t(k) * size_t(g.ny) + size_t(j)) * size_t(g.nx) + size_t(i));
                EXPECT_EQ(phi < 0, exact.inside(x) && d > 0);
                if (d > band) continue;
                ++in_band;
                EXPECT_EQ(std::abs(phi), float(d));
            }
    EXPECT_GT(in_band, 5000);
    EXPECT_LT(level_set.exact_nodes(), level_set.nodes() / 2);
}

TEST(MovingLevelSet, of_an_open_mesh_has_the_sign_of_one_that_is_exact_everywhere) {
    Mesh mesh = triangulated(Sphere{radius}, 64);
    std::erase_if(mesh.triangles, [&](const auto& t) { return mesh.vertices[size_t(t[0])].y < -0.06f; });
    ASSERT_GT(boundary_edges(mesh), 10);
    const MovingLevelSet level_set(mesh, bounding_box(mesh), 0.006, 0);
    const MeshDistance exact(mesh);
    const MovingGrid g = level_set.grid(1);
    Random random(4);
    int inside = 0, other = 0;
    for (int k = 0; k < 20000; ++k) {
        const int i = int(random.number(0, g.nx)), j = int(random.number(0, g.ny)),
                  l = int(random.number(0, g.nz));
        const Vec3d x = cast<double>(g.origin) + double(g.spacing) * Vec3d{double(i), double(j), double(l)};
        const bool in = exact.inside(x);
        other += (g.at((size_t(l) * size_t(g.ny) + size_t(j)) * size_t(g.nx) + size_t(i)) < 0) != in;
        inside += in;
    }
    EXPECT_GT(inside, 2000);
    // Across the hole the sign changes where nothing is; there alone a node may side with those around it.
    EXPECT_LE(other, 20);
}

TEST(MovingLevelSet, has_the_same_bits_for_any_number_of_threads) {
    const auto [one, three] = with_one_and_three_threads([] { return GrowingSphere(0.009); });
    const MovingGrid a = one.level_set.grid(1), b = three.level_set.grid(1);
    const size_t n = one.level_set.nodes();
    EXPECT_EQ(std::memcmp(a.phi, b.phi, n * sizeof(float)), 0);
    EXPECT_EQ(std::memcmp(a.velocity, b.velocity, n * sizeof(Vec3f)), 0);
}

TEST(MovingLevelSet, held_is_at_rest) {
    GrowingSphere sphere(0.01);
    EXPECT_GT(norm(surface_velocity(sphere.level_set.grid(0), Vec3d{0.1, 0, 0})), 0.1);
    sphere.level_set.hold(scaled(sphere.mesh, 1.05));
    const MovingGrid held = sphere.level_set.grid(0);
    EXPECT_EQ(norm(surface_velocity(held, Vec3d{0.1, 0, 0})), 0);
    EXPECT_NEAR(sample(held, Vec3d{0.105, 0, 0}).phi, 0, 3e-4);  // h² / (4 r)
}

}  // namespace
}  // namespace wetcurl
