// Level sets of meshes against analytic shapes: exact nodes, order in the spacing, open meshes, the cache.
#include <cmath>
#include <cstring>
#include <thread>

#include "base/geometry/level_set.h"
#include "base/geometry/shapes.h"
#include "base/log.h"
#include "base/output_file.h"
#include "scratch.h"
#include "tests/base/threads.h"

namespace wetcurl {
namespace {

using testing::bytes_of;
using testing::expect_error;
using testing::Random;
using testing::Scratch;
using testing::with_one_and_three_threads;

bool same_bits(const LevelSet& a, const LevelSet& b) {
    return a.phi().size() == b.phi().size() &&
           std::memcmp(a.phi().data(), b.phi().data(), a.phi().size() * sizeof(float)) == 0;
}

template <class Visit>
void for_nodes(const LevelSet& level_set, Visit visit) {
    const DistanceGrid g = level_set.grid();
    for (int k = 0; k < g.nz; ++k)
        for (int j = 0; j < g.ny; ++j)
            for (int i = 0; i < g.nx; ++i)
                visit(cast<double>(g.origin) + double(g.spacing) * Vec3d{double(i), double(j), double(k)},
                      level_set.phi()[(size_t(k) * size_t(g.ny) + size_t(j)) * size_t(g.nx) + size_t(i)]);
}

TEST(LevelSet, of_a_box_is_exact_at_every_node) {
    // A box of triangles has no error of its own; the spacing is no divisor of it.
    const Box box{{0.11, 0.07, 0.16}};
    const LevelSet level_set(triangulated(box), 0.0171);
    int inside = 0, outside = 0;
    for_nodes(level_set, [&](const Vec3d& x, float phi) {
        const double exact = distance(box, x).phi;
        EXPECT_NEAR(phi, exact, 2e-8);  // vertices are rounded to single precision
        (exact < 0 ? inside : outside)++;
    });
    EXPECT_GT(inside, 500);
    EXPECT_GT(outside, 2000);
}

TEST(LevelSet, of_a_sphere_has_second_order_error_in_the_spacing) {
    const double radius = 0.1;
    const Mesh mesh = triangulated(Sphere{radius}, 512);  // sagitta 2e-6 m, far under the grid's error
    Random random(1);
    double errors[3], normals[3], cells = 8;
    for (int level = 0; level < 3; ++level, cells *= 2) {
        const double h = 2 * radius / cells;
        const LevelSet level_set(mesh, h);
        errors[level] = normals[level] = 0;
        for (int k = 0; k < 20000; ++k) {
            const Vec3d x = (radius + random.number(-0.015, 0.015)) * random.direction();
            const auto s = sample(level_set.grid(), x);
            const auto exact = distance(Sphere{radius}, x);
            errors[level] = std::max(errors[level], std::abs(s.phi - exact.phi));
            normals[level] = std::max(normals[level], norm(s.normal - exact.normal));
        }
    }
    const double order = std::log2(errors[0] / errors[2]) / 2,
                 normal_order = std::log2(normals[0] / normals[2]) / 2;
    RecordProperty("order", std::to_string(order));
    std::printf(
        "level set of a sphere, %g mm radius: error %.3g %.3g %.3g mm, order %.2f; normal %.3g %.3g %.3g, "
        "order %.2f\n",
        1000 * radius, 1000 * errors[0], 1000 * errors[1], 1000 * errors[2], order, normals[0], normals[1],
        normals[2], normal_order);
    EXPECT_GT(errors[2], 5e-6);
    EXPECT_NEAR(order, 2, 0.25);
    EXPECT_NEAR(normal_order, 1, 0.25);  // of the gradient of a trilinear interpolant
    EXPECT_LT(normals[2], 0.1);
}

TEST(LevelSet, normal_is_the_gradient_of_what_is_sampled) {
    const LevelSet level_set(triangulated(Sphere{0.1}, 64), 0.011);
    const DistanceGrid g = level_set.grid();
    Random random(2);
    constexpr double step = 1e-7;
    int tried = 0;
    for (int k = 0; k < 500; ++k) {
        const Vec3d x = random.vector(0.13);
        const Vec3d cell = (1 / double(g.spacing)) * (x - cast<double>(g.origin));
        bool near_border = norm(x) < 0.03;  // the interpolant bends at the borders of cells
        for (double c : {cell.x, cell.y, cell.z}) near_border |= std::abs(c - std::round(c)) < 1e-3;
        if (near_border) continue;
        ++tried;
        const auto phi = [&](double dx, double dy, double dz) {
            return sample(g, x + Vec3d{dx, dy, dz}).phi;
        };
        const Vec3d rise =
            (0.5 / step) * Vec3d{phi(step, 0, 0) - phi(-step, 0, 0), phi(0, step, 0) - phi(0, -step, 0),
                                 phi(0, 0, step) - phi(0, 0, -step)};
        EXPECT_GT(norm(rise), 0.8);
        EXPECT_LT(norm((1 / norm(rise)) * rise - sample(g, x).normal), 1e-6);
    }
    EXPECT_GT(tried, 300);
}

TEST(LevelSet, holds_far_outside_its_grid) {
    const double radius = 0.1;
    const LevelSet level_set(triangulated(Sphere{radius}, 256), 0.005);
    Random random(3);
    for (double far : {0.15, 0.3, 1.0, 10.0})
        for (int k = 0; k < 200; ++k) {
            const Vec3d x = far * random.direction();
            const auto s = sample(level_set.grid(), x);
            // The border's nearest point is not quite that of x: the square of its angle is missing, (0.02 /
            // 0.1)^2 at most.
            EXPECT_GT(s.phi, far - radius - 1e-4);
            EXPECT_LT(s.phi, 1.06 * (far - radius));
            EXPECT_LT(norm(s.normal - (1 / far) * x), 0.2);
            EXPECT_NEAR(norm(s.normal), 1, 1e-12);
        }
}

TEST(LevelSet, is_continuous_across_the_border_of_its_grid) {
    const LevelSet level_set(triangulated(Capsule{0.05, 0.03}, 48), 0.004);
    const DistanceGrid g = level_set.grid();
    const double border = double(g.origin.x) + double(g.spacing) * (g.nx - 1);
    for (double y = -0.1; y < 0.1; y += 0.0037) {
        const auto in = sample(g, Vec3d{border - 1e-9, y, 0.001}),
                   out = sample(g, Vec3d{border + 1e-9, y, 0.001});
        EXPECT_NEAR(in.phi, out.phi, 1e-8);
        EXPECT_LT(norm(in.normal - out.normal), 1e-6);
        EXPECT_GT(in.phi, 0.01);
    }
}

TEST(LevelSet, survives_what_is_no_number) {
    const LevelSet level_set(triangulated(Sphere{0.1}, 16), 0.02);
    const float nan = std::numeric_limits<float>::quiet_NaN(), inf = std::numeric_limits<float>::infinity();
    // The answer is worthless; that it comes without a read out of bounds is the claim (sanitizer build).
    for (const Vec3f& x :
         {Vec3f{nan, 0, 0}, Vec3f{nan, nan, nan}, Vec3f{inf, 0, -inf}, Vec3f{1e30f, -1e30f, 0}})
        (void)sample(level_set.grid(), x), (void)sample(level_set.grid(), cast<Pack<float>>(x));
    EXPECT_LT(sample(level_set.grid(), Vec3f{0.05f, 0, 0}).phi, -0.04f);
}

TEST(LevelSet, in_packs_is_the_plain_one_to_rounding_and_in_a_build_for_parity_to_the_bit) {
    const LevelSet level_set(triangulated(Capsule{0.1, 0.05}, 16), 0.02);
    auto expect = [&]<class T>(T scale) {
        using S = Pack<T>;
        Random random(11);
        // One contraction of a product and a sum is worth a rounding of a distance, and more of a normal.
#ifdef WETCURL_PARITY
        const double rounding = 0;
#else
        const double rounding = 4 * double(std::numeric_limits<T>::epsilon());
#endif
        for (int round = 0; round < 300; ++round) {
            Vec3<S> x;
            // Inside, about the surface, beyond the grid.
            for (int l = 0; l < S::lanes; ++l) {
                const Vec3<T> at = cast<T>(random.vector(double(scale) * (l % 4 == 0 ? 5 : 1)));
                x.x.set(l, at.x), x.y.set(l, at.y), x.z.set(l, at.z);
            }
            const auto packed = sample(level_set.grid(), x);
            for (int l = 0; l < S::lanes; ++l) {
                const auto plain = sample(level_set.grid(), Vec3<T>{x.x[l], x.y[l], x.z[l]});
                EXPECT_NEAR(packed.phi[l], plain.phi, rounding);
                const Vec3<T> n{packed.normal.x[l], packed.normal.y[l], packed.normal.z[l]};
                EXPECT_LE(norm(n - plain.normal), 100 * rounding);
            }
        }
    };
    expect(0.12f), expect(0.12);
}

// Without its top: every triangle above `height` is left out.
Mesh opened(const Mesh& closed, float height) {
    Mesh open{closed.vertices, {}};
    for (const auto& t : closed.triangles) {
        bool below = false;
        for (int c : t) below |= closed.vertices[size_t(c)].y < height;
        if (below) open.triangles.push_back(t);
    }
    return open;
}

TEST(LevelSet, of_an_open_mesh_has_the_right_sign_away_from_the_hole) {
    const double radius = 0.1;
    const Mesh closed = triangulated(Sphere{radius}, 96), open = opened(closed, 0.085f);
    ASSERT_GT(boundary_edges(open), 50);
    const LevelSet level_set(open, 0.006);
    Random random(4);
    int inside = 0;
    for (int k = 0; k < 5000; ++k) {
        const Vec3d x = random.number(0, 0.12) * random.direction();
        const double exact = norm(x) - radius;
        if (x.y > 0.05 || std::abs(exact) < 0.002)
            continue;  // the hole has a radius of 53 mm at 85 mm height
        const float phi = float(sample(level_set.grid(), x).phi);
        EXPECT_EQ(phi < 0, exact < 0) << x.x << " " << x.y << " " << x.z;
        inside += exact < 0;
        if (x.y < 0 && norm(x) > 0.02) {  // the distance has a kink at the centre
            EXPECT_NEAR(phi, exact, 6e-4);
        }
    }
    EXPECT_GT(inside, 1000);
}

TEST(LevelSet, does_not_mind_which_way_triangles_are_turned) {
    Mesh mesh = triangulated(Sphere{0.1}, 48);
    const LevelSet outward(mesh, 0.01);
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    const LevelSet inward(mesh, 0.01);
    for (size_t i = 0; i < outward.phi().size(); ++i) EXPECT_NEAR(outward.phi()[i], inward.phi()[i], 1e-7);
    EXPECT_LT(sample(inward.grid(), Vec3d{0, 0, 0}).phi, -0.09);
}

TEST(LevelSet, has_the_same_bits_for_any_number_of_threads) {
    const Mesh mesh = triangulated(Capsule{0.05, 0.03}, 48);
    const auto [one, three] = with_one_and_three_threads([&] { return LevelSet(mesh, 0.004); });
    EXPECT_TRUE(same_bits(one, three));
    EXPECT_GT(one.phi().size(), 10000u);
}

TEST(LevelSet, gives_the_longest_side_96_cells_unless_told_otherwise) {
    const LevelSet level_set(triangulated(Box{{0.01, 0.24, 0.02}}));
    EXPECT_NEAR(level_set.grid().spacing, 0.48 / 96, 1e-8);
    EXPECT_GT(level_set.build_seconds(), 0);
    EXPECT_EQ(level_set.bytes(), level_set.phi().size() * 4);
}

TEST(LevelSet, refuses_absurd_grids_and_meshes_without_extent) {
    const Mesh box = triangulated(Box{});
    expect_error([&] { LevelSet(box, 1e-5); }, {"spacing", "mm or more", "2^27"});
    expect_error([&] { LevelSet(box, -0.01); }, {"spacing", "above 0"});
    expect_error([&] { LevelSet(box, std::nan("")); }, {"spacing", "above 0"});
    expect_error([] { LevelSet(Mesh{}, 0.01); }, {"no extent"});
    expect_error([] { LevelSet({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}}}, 0.1); }, {"has an area"});
}

// ---- the cache ----

std::string only_file_in(const std::string& folder) {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        found.push_back(entry.path().string());
    EXPECT_EQ(found.size(), 1u);
    return found.empty() ? "" : found[0];
}

TEST(LevelSetCache, gives_back_the_same_bits) {
    const Scratch scratch;
    const Mesh mesh = triangulated(Sphere{0.1}, 48);
    const auto made = LevelSet::cached(mesh, 0.008, scratch.path()),
               read = LevelSet::cached(mesh, 0.008, scratch.path());
    EXPECT_FALSE(made->from_cache());
    EXPECT_TRUE(read->from_cache());
    EXPECT_TRUE(same_bits(*made, *read));
    EXPECT_EQ(made->build_seconds(), read->build_seconds());
    EXPECT_EQ(made->grid().nx, read->grid().nx);
    EXPECT_EQ(read->mesh().triangles, mesh.triangles);
    only_file_in(scratch.path());
}

TEST(LevelSetCache, tells_meshes_and_spacings_apart) {
    const Scratch scratch;
    Mesh mesh = triangulated(Sphere{0.1}, 24);
    const auto made = LevelSet::cached(mesh, 0.0195, scratch.path());
    const auto other = LevelSet::cached(mesh, 0.0196, scratch.path());
    EXPECT_FALSE(other->from_cache());
    ASSERT_EQ(made->phi().size(), other->phi().size());  // the size alone would not tell them apart
    mesh.vertices[7].x *= 1.01f;
    EXPECT_FALSE(LevelSet::cached(mesh, 0.0195, scratch.path())->from_cache());
    mesh.triangles.pop_back();
    EXPECT_FALSE(LevelSet::cached(mesh, 0.0195, scratch.path())->from_cache());
}

TEST(LevelSetCache, rebuilds_damaged_files) {
    set_log_level(LogLevel::error);  // the warnings are meant
    const Scratch scratch;
    const Mesh mesh = triangulated(Sphere{0.1}, 24);
    const auto made = LevelSet::cached(mesh, 0.01, scratch.path());
    const std::string file = only_file_in(scratch.path()), good = bytes_of(file),
                      name = file.substr(scratch.path().size() + 1);
    std::string flipped = good;
    flipped[good.size() / 2] = char(flipped[good.size() / 2] ^ 1);
    for (const std::string& bad : {std::string(), good.substr(0, 100), good.substr(0, good.size() / 2),
                                   good.substr(0, good.size() - 1), std::string(5000, 'x'), flipped}) {
        scratch.file(name, bad);
        const auto again = LevelSet::cached(mesh, 0.01, scratch.path());
        EXPECT_FALSE(again->from_cache()) << bad.size() << " bytes";
        EXPECT_TRUE(same_bits(*made, *again));
        EXPECT_TRUE(LevelSet::cached(mesh, 0.01, scratch.path())->from_cache());
    }
    set_log_level(LogLevel::info);
}

TEST(LevelSetCache, is_left_to_the_process_that_writes_it) {
    const Scratch scratch;
    const Mesh mesh = triangulated(Sphere{0.1}, 24);
    const auto cached = [&] { return LevelSet::cached(mesh, 0.01, scratch.path()); };
    const auto made = cached();
    const std::string file = only_file_in(scratch.path());
    std::filesystem::remove(file);
    {
        OutputFile other(file, true);
        other.write("half");
        const auto own = cached();
        EXPECT_FALSE(own->from_cache());
        EXPECT_TRUE(same_bits(*made, *own));
        EXPECT_EQ(bytes_of(other.partial()), "half");
        EXPECT_EQ(only_file_in(scratch.path()), other.partial());
    }
    std::vector<std::thread> processes;
    for (int k = 0; k < 4; ++k) processes.emplace_back([&] { EXPECT_TRUE(same_bits(*made, *cached())); });
    for (auto& process : processes) process.join();
    EXPECT_TRUE(cached()->from_cache());
    EXPECT_EQ(only_file_in(scratch.path()), file);
}

TEST(LevelSetCache, does_without_a_folder_that_cannot_be_written) {
    const Scratch scratch;
    const std::string no_folder = scratch.file("a_file", "x") + "/below";
    const Mesh mesh = triangulated(Sphere{0.1}, 24);
    for (const std::string& folder : {no_folder, std::string()}) {
        const auto level_set = LevelSet::cached(mesh, 0.02, folder);
        EXPECT_FALSE(level_set->from_cache());
        EXPECT_LT(sample(level_set->grid(), Vec3d{0, 0, 0}).phi, -0.09);
    }
}

TEST(LevelSetCache, stands_in_the_cache_folder_of_the_user) {
    const char* cache = std::getenv("XDG_CACHE_HOME");
    const std::string before = cache ? cache : "";
    setenv("XDG_CACHE_HOME", "/somewhere", 1);
    EXPECT_EQ(cache_folder(), "/somewhere/wetcurl");
    unsetenv("XDG_CACHE_HOME");
    const char* home = std::getenv("HOME");
    EXPECT_EQ(cache_folder(), home ? std::string(home) + "/.cache/wetcurl" : "");
    if (cache) setenv("XDG_CACHE_HOME", before.c_str(), 1);
}

// ---- real heads ----

class RealHead : public ::testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(files, RealHead, ::testing::Values("female_head.obj", "wig_head.obj"),
                         [](const auto& info) {
                             return std::string(info.param).substr(0, std::string(info.param).find('.'));
                         });

TEST_P(RealHead, builds_a_level_set_that_agrees_with_the_surface) {
    const std::string path = std::string(WETCURL_SHARED_DIR) + "/data/" + GetParam();
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "SKIP: no " << path;
    const Mesh mesh = read_mesh(path, 0.01);
    const LevelSet level_set(mesh);
    const DistanceGrid g = level_set.grid();
    std::printf("%s: %zu triangles, %d x %d x %d nodes of %.2f mm, %.1f MB, built in %.2f s\n", GetParam(),
                mesh.triangles.size(), g.nx, g.ny, g.nz, 1000 * double(g.spacing),
                double(level_set.bytes()) / 1e6, level_set.build_seconds());
    double mean = 0;
    for (const Vec3f& v : mesh.vertices) mean += std::abs(sample(g, v).phi) / double(mesh.vertices.size());
    EXPECT_LT(mean, 0.1 * double(g.spacing));
    int inside = 0;
    for (float phi : level_set.phi()) inside += phi < 0;
    const double share = double(inside) / double(level_set.phi().size());
    EXPECT_GT(share, 0.1);
    EXPECT_LT(share, 0.7);
    for (double side : {double(g.origin.x), double(g.origin.x) + double(g.spacing) * (g.nx - 1)})
        EXPECT_GT(sample(g, Vec3d{side, 0, 0}).phi, 0);
}

}  // namespace
}  // namespace wetcurl
