// Analytic shapes against geometry: values, unit gradients, normals, packs and their drawn surfaces.
#include "base/geometry/shapes.h"
#include "scratch.h"

namespace wetcurl {
namespace {

using testing::Random;

constexpr double eps = 1e-14;

std::vector<Shape> analytic_shapes() {
    return {Sphere{0.3}, Capsule{0.4, 0.2}, Capsule{0, 0.25}, Box{{0.3, 0.1, 0.5}}, Plane{}};
}

TEST(Sphere, distance_is_to_the_centre_less_the_radius) {
    const auto s = distance(Shape(Sphere{0.3}), Vec3d{0.3, 0.4, 0});
    EXPECT_NEAR(s.phi, 0.2, eps);
    EXPECT_NEAR(norm(s.normal - Vec3d{0.6, 0.8, 0}), 0, eps);
    EXPECT_NEAR(distance(Shape(Sphere{0.3}), Vec3d{0, 0.1, 0}).phi, -0.2, eps);
}

TEST(Capsule, is_round_beyond_its_segment_and_a_cylinder_beside_it) {
    const Shape capsule = Capsule{0.4, 0.2};
    EXPECT_NEAR(distance(capsule, Vec3d{0.5, 0.3, 0}).phi, 0.3, eps);
    EXPECT_NEAR(distance(capsule, Vec3d{0.3, 0.8, 0}).phi, 0.3, eps);  // 0.3, 0.4, 0.5 from the cap's centre
    EXPECT_NEAR(distance(capsule, Vec3d{0.3, -0.8, 0}).phi, 0.3, eps);
    EXPECT_NEAR(distance(capsule, Vec3d{0, 0, 0.05}).phi, -0.15, eps);
    EXPECT_NEAR(norm(distance(capsule, Vec3d{0.5, 0.3, 0}).normal - Vec3d{1, 0, 0}), 0, eps);
}

TEST(Box, distance_is_to_faces_edges_and_corners) {
    const Shape box = Box{{0.3, 0.1, 0.5}};
    EXPECT_NEAR(distance(box, Vec3d{0.1, 0.4, -0.2}).phi, 0.3, eps);      // a face
    EXPECT_NEAR(distance(box, Vec3d{0.6, -0.5, 0.2}).phi, 0.5, eps);      // an edge: 0.3, 0.4
    EXPECT_NEAR(distance(box, Vec3d{0.4, 0.3, -0.7}).phi, 0.3, eps);      // a corner: 0.1, 0.2, 0.2
    EXPECT_NEAR(distance(box, Vec3d{0.05, -0.08, 0.1}).phi, -0.02, eps);  // inside: the nearest face
    EXPECT_NEAR(distance(box, Vec3d{0.05, -0.08, 0.1}).normal.y, -1, eps);
    EXPECT_NEAR(distance(box, Vec3d{0.29, 0, 0}).normal.x, 1, eps);
    EXPECT_NEAR(distance(box, Vec3d{0, 0, -0.48}).normal.z, -1, eps);
}

TEST(Plane, is_the_height) {
    EXPECT_EQ(distance(Shape(Plane{}), Vec3d{3, -0.2, 5}).phi, -0.2);
    EXPECT_EQ(distance(Shape(Plane{}), Vec3d{3, -0.2, 5}).normal.y, 1);
}

// Places where distance is smooth: the step of the differences must not cross a medial plane of the box.
bool smooth_at(const Shape& shape, const Vec3d& x, double step) {
    const auto* box = std::get_if<Box>(&shape);
    if (!box) return std::holds_alternative<Plane>(shape) || norm(x) > 0.05;
    const Vec3d q{std::abs(x.x) - box->half.x, std::abs(x.y) - box->half.y, std::abs(x.z) - box->half.z};
    const double away[] = {q.x - q.y, q.y - q.z, q.z - q.x, q.x, q.y, q.z, x.x, x.y, x.z};
    for (double a : away)
        if (std::abs(a) < 10 * step) return false;
    return true;
}

TEST(Shapes, gradient_by_differences_has_length_one_and_is_the_normal) {
    Random random(1);
    constexpr double step = 1e-5;  // truncation step^2 / distance^2, rounding 1e-16 / step: both under 1e-7
    for (const Shape& shape : analytic_shapes()) {
        int tried = 0;
        for (int k = 0; k < 500; ++k) {
            const Vec3d x = random.vector(0.8);
            if (!smooth_at(shape, x, step)) continue;
            ++tried;
            const auto phi = [&](double dx, double dy, double dz) {
                return distance(shape, x + Vec3d{dx, dy, dz}).phi;
            };
            const Vec3d rise =
                (0.5 / step) * Vec3d{phi(step, 0, 0) - phi(-step, 0, 0), phi(0, step, 0) - phi(0, -step, 0),
                                     phi(0, 0, step) - phi(0, 0, -step)};
            EXPECT_NEAR(norm(rise), 1, 1e-6) << "shape " << shape.index();
            EXPECT_LT(norm(rise - distance(shape, x).normal), 1e-6) << "shape " << shape.index();
        }
        EXPECT_GT(tried, 100) << "shape " << shape.index();
    }
}

template <class T>
void expect_unit_normal(const Shape& shape, const Vec3<T>& x) {
    const auto s = distance(shape, x);
    EXPECT_TRUE(std::isfinite(s.phi)) << shape.index();
    EXPECT_NEAR(norm(s.normal), 1, 1e-6)
        << "shape " << shape.index() << " at " << x.x << " " << x.y << " " << x.z;
}

TEST(Shapes, normals_are_unit_everywhere_even_at_centres_axes_faces_and_corners) {
    Random random(2);
    const std::vector<Vec3d> special{{0, 0, 0},       {0, 0.2, 0},         {0, 0.4, 0},
                                     {0, 0.6, 0},     {0.3, 0, 0},         {0.3, 0.1, 0},
                                     {0.3, 0.1, 0.5}, {1e-30, 0, 0},       {0, -1e-20, 1e-20},
                                     {1e4, 1e4, 1e4}, {0.3 + 1e-17, 0, 0}, {-0.3, -0.1, -0.5}};
    for (const Shape& shape : analytic_shapes()) {
        for (const Vec3d& x : special) {
            expect_unit_normal(shape, x);
            expect_unit_normal(shape, cast<float>(x));
        }
        for (int k = 0; k < 200; ++k) expect_unit_normal(shape, cast<float>(random.vector()));
    }
}

TEST(Shapes, in_packs_equal_the_plain_formula_in_every_lane) {
    using P = Pack<float>;
    Random random(3);
    auto shapes = analytic_shapes();
    shapes.push_back(std::make_shared<const LevelSet>(triangulated(Box{{0.1, 0.2, 0.1}}), 0.02));
    for (const Shape& shape : shapes) {
        Vec3<P> packed;
        std::vector<Vec3f> plain(P::lanes);
        for (int l = 0; l < P::lanes; ++l) {
            plain[size_t(l)] = l == 0 ? Vec3f{0, 0, 0} : cast<float>(random.vector(0.6));
            packed.x.set(l, plain[size_t(l)].x), packed.y.set(l, plain[size_t(l)].y),
                packed.z.set(l, plain[size_t(l)].z);
        }
        const auto s = distance(shape, packed);
        for (int l = 0; l < P::lanes; ++l) {
            const auto wanted = distance(shape, plain[size_t(l)]);
            EXPECT_NEAR(s.phi[l], wanted.phi, 2e-7) << "shape " << shape.index();
            const Vec3f n{s.normal.x[l], s.normal.y[l], s.normal.z[l]};
            EXPECT_LT(norm(n - wanted.normal), 1e-5) << "shape " << shape.index();
            EXPECT_GT(norm(n), 0.9f);
        }
    }
}

TEST(Shapes, single_precision_is_the_rounded_double) {
    Random random(4);
    for (const Shape& shape : analytic_shapes())
        for (int k = 0; k < 100; ++k) {
            const Vec3f x = cast<float>(random.vector());
            EXPECT_NEAR(distance(shape, x).phi, distance(shape, cast<double>(x)).phi, 5e-7);
        }
}

double area_of(const Mesh& mesh) {
    double sum = 0;
    for (const auto& t : mesh.triangles) {
        const Vec3d a = cast<double>(mesh.vertices[size_t(t[0])]);
        sum += 0.5 * norm(cross(cast<double>(mesh.vertices[size_t(t[1])]) - a,
                                cast<double>(mesh.vertices[size_t(t[2])]) - a));
    }
    return sum;
}

// Where distances are sampled one push does not reach the surface; another goes on from there.
TEST(PushedOut, of_a_level_set_in_as_many_pushes_as_it_takes) {
    const LevelSet body(triangulated(Box{{0.05, 0.03, 0.04}}), 0.01);
    const ShapeView shape = view_of(std::make_shared<const LevelSet>(body));
    std::mt19937 random(8);
    std::uniform_real_distribution<float> in(-0.05f, 0.05f);
    float after_one = 0, after_all = 0;
    for (int k = 0; k < 2000; ++k) {
        const Vec3f x{in(random), 0.6f * in(random), 0.8f * in(random)};
        for (const float allowed : {0.f, -0.005f}) {
            const auto d = distance(shape, x);
            const Vec3f once = d.phi < allowed ? x + (allowed - d.phi) * d.normal : x,
                        out = pushed_out(shape, x, allowed);
            after_one = std::max(after_one, allowed - distance(shape, once).phi);
            after_all = std::max(after_all, allowed - distance(shape, out).phi);
            if (d.phi >= allowed) {
                EXPECT_EQ(norm(out - x), 0);
            }
        }
    }
    EXPECT_GT(after_one, 1e-3f);
    EXPECT_LT(after_all, 0.02f * after_one);
}

// Straight through a ball, past its centre: each particle comes out on its own side.
TEST(LedAround, a_strand_goes_around_what_it_would_cross_at_no_more_than_twice_its_length) {
    const ShapeView ball = view_of(Sphere{0.1});
    auto out = [&](const Vec3f& x) { return pushed_out(ball, x, 0.f); };
    constexpr int n = 60;
    constexpr float length = 0.01f;
    std::vector<Vec3f> straight, strand;
    for (int i = 0; i < n; ++i) straight.push_back({0.02f, 0, 0.2f - length * float(i)});
    for (const Vec3f& x : straight) strand.push_back(out(x));
    float torn = 0;
    for (int i = 1; i < n; ++i) torn = std::max(torn, norm(strand[i] - strand[i - 1]));
    ASSERT_GT(torn, 4 * length);
    const std::vector<Vec3f> pushed = strand;
    for (int i = 1; i < n; ++i) strand[i] = led_around(strand[i - 1], strand[i], torn_lengths * length, out);
    int led = 0;
    for (int i = 1; i < n; ++i) {
        EXPECT_LT(norm(strand[i] - strand[i - 1]), 1.01f * torn_lengths * length) << i;
        EXPECT_GT(norm(strand[i]), norm(pushed[i]) < 0.1001f ? 0.0999f : 0.f) << i;
        if (norm(strand[i] - pushed[i]) == 0) continue;
        EXPECT_LT(norm(strand[i]), 0.12f) << i;
        EXPECT_GT(norm(strand[i] - strand[i - 1]), 0.99f * torn_lengths * length) << i;
        ++led;
    }
    EXPECT_GT(led, 3);
    EXPECT_LT(led, 20);
    EXPECT_EQ(norm(strand[n - 1] - pushed[n - 1]), 0);  // it catches up
    // What is not torn stays to the bit.
    for (int i = 1; i < n; ++i)
        EXPECT_EQ(norm(led_around(straight[i - 1], straight[i], torn_lengths * length, out) - straight[i]),
                  0);
    // Through the centre no way is the shorter one.
    EXPECT_LT(norm(led_around({0, 0, 0.1f}, {0, 0, -0.1f}, torn_lengths * length, out)), 0.1001f);
}

TEST(Triangulated, vertices_lie_on_the_surface) {
    for (const Shape& shape : analytic_shapes())
        for (const Vec3f& v : triangulated(shape).vertices)
            EXPECT_NEAR(distance(shape, v).phi, 0, 1e-7) << shape.index();
}

TEST(Triangulated, surfaces_have_the_area_of_their_shape) {
    constexpr double pi = 3.14159265358979;
    // Inscribed polygons of 200 sides lack (pi / 200)^2 of their area, give or take a factor.
    EXPECT_NEAR(area_of(triangulated(Sphere{0.3}, 200)) / (4 * pi * 0.09), 1, 1e-3);
    EXPECT_NEAR(area_of(triangulated(Capsule{0.4, 0.2}, 200)) / (4 * pi * 0.04 + 2 * pi * 0.2 * 0.8), 1,
                1e-3);
    EXPECT_NEAR(area_of(triangulated(Box{{0.3, 0.1, 0.5}})), 8 * (0.03 + 0.05 + 0.15), 1e-6);
    EXPECT_NEAR(area_of(triangulated(Plane{})), 1, 1e-6);
}

TEST(Triangulated, solids_are_closed_and_turned_outward) {
    for (const Shape& shape : {Shape(Sphere{0.3}), Shape(Capsule{0.4, 0.2}), Shape(Box{{0.3, 0.1, 0.5}})}) {
        const Mesh mesh = triangulated(shape);
        EXPECT_EQ(boundary_edges(mesh), 0) << shape.index();
        EXPECT_NEAR(MeshDistance(mesh).winding_number({0.01, 0.02, -0.03}), 1, 0.02) << shape.index();
    }
    const Mesh plane = triangulated(Plane{});
    EXPECT_EQ(boundary_edges(plane), 4);
    const Vec3d a = cast<double>(plane.vertices[0]);
    EXPECT_GT(cross(cast<double>(plane.vertices[1]) - a, cast<double>(plane.vertices[2]) - a).y, 0.5);
}

TEST(Triangulated, level_set_gives_the_mesh_it_was_made_from) {
    const Mesh mesh = triangulated(Box{{0.1, 0.2, 0.1}});
    const Shape shape = std::make_shared<const LevelSet>(mesh, 0.05);
    EXPECT_EQ(triangulated(shape).triangles, mesh.triangles);
}

}  // namespace
}  // namespace wetcurl
