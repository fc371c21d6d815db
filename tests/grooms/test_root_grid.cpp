// Roots on a grid: sizes, whole and without doubles, neighbours near; domes, disks of triangles, ARAP.
#include <algorithm>
#include <map>
#include <numbers>
#include <set>

#include "base/geometry/shapes.h"
#include "solver/grooms/flatten.h"
#include "solver/grooms/nearest.h"
#include "solver/grooms/root_grid.h"
#include "tests/base/scratch.h"

namespace wetcurl {
namespace {

using namespace testing;

constexpr double pi = std::numbers::pi;

// Roots spread at random, even in area, over the cap of a ball of 0.1 m round `pole`.
std::vector<Vec3d> cap_roots(int count, const Vec3d& pole = {0, 1, 0}, double coverage = 1.5,
                             unsigned seed = 3) {
    Random random(seed);
    std::vector<Vec3d> roots;
    while (int(roots.size()) < count)
        if (const Vec3d d = random.direction(); dot(d, pole) > std::cos(coverage)) roots.push_back(0.1 * d);
    return roots;
}

double spread_of_pixels(const RootGrid& grid, const std::vector<Vec3d>& roots) {
    double sum = 0;
    int pairs = 0;
    for (int r = 0; r < grid.height; ++r)
        for (int c = 0; c + 1 < grid.width; ++c)
            if (grid.at(c, r) >= 0 && grid.at(c + 1, r) >= 0) {
                sum += norm(roots[size_t(grid.at(c, r))] - roots[size_t(grid.at(c + 1, r))]);
                ++pairs;
            }
    return sum / pairs;
}

// ---- sizes

TEST(GridSize, is_near_square_and_has_a_pixel_for_each_root_and_few_more) {
    for (int roots = 1; roots <= 12000; ++roots) {
        const auto [w, h] = finest_grid(roots);
        ASSERT_GE(h, 1);
        ASSERT_GE(w * h, roots);
        ASSERT_LE(w * h - roots, most_holes({w, h})) << roots;
        ASSERT_GE(w, h);
        ASSERT_LE(w, 1.5 * h + 1);
        if (roots > 47) {
            ASSERT_LE(w * h, 1.15 * roots) << roots;
        }
        if (roots > 1100) {  // it nests twice
            ASSERT_EQ(w % 4 + h % 4, 0) << roots;
        }
    }
}

// ---- assignment

// Every root is at one pixel, or, where there are fewer pixels than roots, every pixel has one; what is empty
// lies where no coarser grid has a root.
void expect_one_root_a_pixel(const RootGrid& grid, size_t roots) {
    std::set<int> seen;
    for (int r = 0; r < grid.height; ++r)
        for (int c = 0; c < grid.width; ++c)
            if (const int s = grid.at(c, r); s >= 0)
                EXPECT_TRUE(seen.insert(s).second) << s;
            else
                EXPECT_TRUE(c % 2 == 1 && r % 2 == 1) << c << " " << r;
    EXPECT_EQ(seen.size(), std::min(roots, grid.strand.size()));
    EXPECT_GE(*seen.begin(), 0);
    EXPECT_LT(*seen.rbegin(), int(roots));
}

TEST(RootGrid, every_root_has_a_pixel_of_its_own) {
    for (int count : {1, 2, 3, 5, 7, 13, 64, 100, 101, 1000, 2228}) {
        const auto roots = cap_roots(count);
        const RootLayout layout = lay_on_grid(roots, nullptr);
        expect_one_root_a_pixel(layout.grid, roots.size());
        EXPECT_EQ(layout.quality.pixels, count);
        EXPECT_EQ(layout.quality.roots, count);
    }
}

TEST(RootGrid, a_shuffled_lattice_is_found_again) {
    Random random(5);
    std::vector<Vec3d> roots;
    for (int r = 0; r < 16; ++r)
        for (int c = 0; c < 24; ++c) roots.push_back({0.01 * c, 0, 0.01 * r});
    std::shuffle(roots.begin(), roots.end(), std::mt19937(1));
    const RootLayout layout = lay_on_grid(roots, nullptr);
    EXPECT_EQ(layout.grid.width, 24);
    EXPECT_EQ(layout.grid.height, 16);
    EXPECT_NEAR(layout.quality.neighbour_mean, 0.01, 1e-12);
    EXPECT_NEAR(layout.quality.ratio(), 1, 1e-9);
}

TEST(RootGrid, neighbours_stay_neighbours_ten_times_better_than_at_random) {
    for (const Vec3d& pole : {Vec3d{0, 1, 0}, Vec3d{0, 0.6, -0.8}}) {
        const auto roots = cap_roots(3000, pole);
        const RootLayout layout = lay_on_grid(roots, nullptr);
        // Roots at random are 0.5 of a lattice's spacing from their nearest one, so 2 is the best to hope
        // for.
        EXPECT_LT(layout.quality.ratio(), 3.0);
        EXPECT_GT(layout.quality.ratio(), 1.5);
        RootGrid shuffled = layout.grid;
        std::shuffle(shuffled.strand.begin(), shuffled.strand.end(), std::mt19937(1));
        EXPECT_GT(grid_quality(shuffled, roots).neighbour_mean, 10 * layout.quality.neighbour_mean);
        // Coarser grids are its strides: their neighbours are twice and four times as far, not more by much.
        Groom groom;
        groom.rest = Strands(int(roots.size()), 2);
        groom.normal.resize(roots.size());
        groom.grid = layout.grid;
        for (int stride : {2, 4}) {
            std::vector<int> kept;
            RootGrid coarse = coarsened(groom, stride, &kept).grid;
            for (int& s : coarse.strand) s = kept[size_t(s)];
            EXPECT_LT(spread_of_pixels(coarse, roots), 1.2 * stride * spread_of_pixels(layout.grid, roots))
                << stride;
        }
    }
}

TEST(RootGrid, the_better_of_the_assignments_is_kept) {
    const auto roots = cap_roots(1000);
    const auto places = parameterised(roots, nullptr);
    const double kept = lay_on_grid(roots, nullptr, finest_grid(1000)).quality.neighbour_mean;
    double best = 1, worst = 0;
    for (Cuts cuts : {Cuts::longer_side, Cuts::rows_first}) {
        RootGrid grid = assigned(places, finest_grid(1000), cuts);
        expect_one_root_a_pixel(grid, roots.size());
        untangle(grid, roots);
        best = std::min(best, grid_quality(grid, roots).neighbour_mean);
        worst = std::max(worst, grid_quality(grid, roots).neighbour_mean);
    }
    EXPECT_GT(worst, 1.05 * best);
    EXPECT_EQ(kept, best);
}

TEST(RootGrid, exchanging_roots_only_ever_shortens_the_way) {
    const auto roots = cap_roots(800);
    RootGrid grid = assigned(parameterised(roots, nullptr), {24, 32}, Cuts::rows_first);
    const double before = grid_quality(grid, roots).neighbour_mean;
    EXPECT_GT(untangle(grid, roots), 100);
    EXPECT_LT(grid_quality(grid, roots).neighbour_mean, 0.95 * before);
    expect_one_root_a_pixel(grid, roots.size());
    EXPECT_EQ(untangle(grid, roots), 0);
}

TEST(RootGrid, roots_of_no_extent_in_a_line_or_in_one_place_do_no_harm) {
    std::vector<Vec3d> line, one_place(40, Vec3d{0.1, 0.2, 0.3});
    for (int i = 0; i < 40; ++i) line.push_back({0.01 * i, 0.005 * i, 0});
    for (const auto& roots : {line, one_place}) {
        const RootLayout layout = lay_on_grid(roots, nullptr);
        expect_one_root_a_pixel(layout.grid, roots.size());
        EXPECT_TRUE(std::isfinite(layout.quality.ratio()));
    }
    expect_error([] { lay_on_grid({}, nullptr); }, {"no root"});
    expect_error([&] { lay_on_grid(line, nullptr, {8, 8}); }, {"8 x 8", "40"});
}

TEST(RootGrid, nearest_points_are_those_of_a_plain_search) {
    const auto points = cap_roots(300);
    const NearestPoint nearest(points);
    for (size_t i = 0; i < points.size(); ++i) {
        double best = 1;
        for (size_t j = 0; j < points.size(); ++j)
            if (i != j) best = std::min(best, norm(points[i] - points[j]));
        EXPECT_EQ(nearest.distance(points[i], int(i)), best);
        EXPECT_EQ(nearest.distance(points[i]), 0);
    }
}

// ---- domes

TEST(RootDome, finds_the_ball_that_roots_stand_on_and_keeps_distances_along_meridians) {
    const Vec3d pole = normalized(Vec3d{0.2, 0.8, -0.6}, Vec3d{0, 1, 0}), away{0.5, -1, 2};
    auto roots = cap_roots(500, pole);
    for (auto& x : roots) x += away;
    const RootDome dome = dome_of(roots);
    ASSERT_FALSE(dome.flat);
    EXPECT_NEAR(dome.radius, 0.1, 1e-9);
    EXPECT_LT(norm(dome.centre - away), 1e-9);
    EXPECT_GT(dot(dome.axis, pole), 0.99);
    for (const auto& x : roots) {
        EXPECT_NEAR(norm(dome.project(x)), 0.1 * std::acos(dot(x - away, dome.axis) / 0.1), 1e-9);
        EXPECT_NEAR(dot(dome.outward(x), x - away), 0.1, 1e-9);
    }
}

TEST(RootDome, a_plane_of_roots_is_kept_as_it_is) {
    Random random(2);
    std::vector<Vec3d> roots;
    for (int i = 0; i < 100; ++i) roots.push_back({random.number(), 3, random.number()});
    const RootDome dome = dome_of(roots);
    EXPECT_TRUE(dome.flat);
    EXPECT_NEAR(dome.outward(roots[0]).y, 1, 1e-9);
    for (int i = 1; i < 100; ++i)
        EXPECT_NEAR(norm(dome.project(roots[size_t(i)]) - dome.project(roots[0])),
                    norm(roots[size_t(i)] - roots[0]), 1e-9);
}

// ---- disks of triangles

// A surface over an n x m lattice of parameters, each cell two triangles.
template <class Surface>
Mesh lattice_mesh(int n, int m, Surface surface, bool closed_u = false, bool closed_v = false) {
    Mesh mesh;
    for (int j = 0; j < m; ++j)
        for (int i = 0; i < n; ++i) mesh.vertices.push_back(cast<float>(surface(double(i), double(j))));
    auto at = [&](int i, int j) { return (j % m) * n + i % n; };
    for (int j = 0; j < m - !closed_v; ++j)
        for (int i = 0; i < n - !closed_u; ++i) {
            mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
            mesh.triangles.push_back({at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    return mesh;
}

Mesh torus() {
    return lattice_mesh(
        24, 16,
        [](double i, double j) {
            const double a = 2 * pi * i / 24, b = 2 * pi * j / 16, r = 0.1 + 0.04 * std::cos(b);
            return Vec3d{r * std::cos(a), 0.04 * std::sin(b), r * std::sin(a)};
        },
        true, true);
}

// Vertices - edges + triangles, and the loops that edges of one triangle form.
struct Topology {
    int euler = 0, rims = 0;
    bool simple_rim = true;
};
Topology topology(const Mesh& mesh) {
    std::map<std::pair<int, int>, int> edges;
    for (const auto& t : mesh.triangles)
        for (size_t k = 0; k < 3; ++k) ++edges[std::minmax(t[k], t[(k + 1) % 3])];
    Topology out;
    out.euler = int(mesh.vertices.size()) - int(edges.size()) + int(mesh.triangles.size());
    std::map<int, std::vector<int>> rim;
    for (const auto& [edge, count] : edges)
        if (count == 1) {
            rim[edge.first].push_back(edge.second);
            rim[edge.second].push_back(edge.first);
        }
    std::set<int> walked;
    for (const auto& [start, two] : rim) {
        out.simple_rim = out.simple_rim && two.size() == 2;
        if (walked.count(start)) continue;
        ++out.rims;
        std::vector<int> stack{start};
        while (!stack.empty()) {
            const int v = stack.back();
            stack.pop_back();
            if (walked.insert(v).second) stack.insert(stack.end(), rim[v].begin(), rim[v].end());
        }
    }
    return out;
}

TEST(Disk, is_a_disk_on_balls_rings_and_patches_with_holes) {
    const Mesh ball = triangulated(Sphere{0.1}, 32), ring = torus();
    for (const Mesh* mesh : {&ball, &ring})
        for (int seed : {0, 100, 333})
            for (bool holes : {false, true}) {
                std::vector<char> allowed(mesh->triangles.size(), 1);
                Random random(unsigned(seed + 1));
                for (auto& a : allowed) a = !holes || random.number() < 0.8;
                allowed[size_t(seed)] = 1;
                const auto disk = disk_of_triangles(*mesh, allowed, seed);
                const Topology t = topology(submesh(*mesh, disk));
                EXPECT_EQ(t.euler, 1);
                EXPECT_EQ(t.rims, 1);
                EXPECT_TRUE(t.simple_rim);
                EXPECT_GT(disk.size(), (holes ? 0.4 : 0.8) * double(mesh->triangles.size()));
                for (int triangle : disk) EXPECT_TRUE(allowed[size_t(triangle)]);
            }
}

// ---- ARAP

double worst_edge_error(const Mesh& mesh, const std::vector<Planar>& place) {
    double worst = 0;
    for (const auto& t : mesh.triangles)
        for (size_t k = 0; k < 3; ++k) {
            const size_t a = size_t(t[k]), b = size_t(t[(k + 1) % 3]);
            const double length = norm(cast<double>(mesh.vertices[a] - mesh.vertices[b]));
            worst = std::max(worst, std::abs(norm(place[a] - place[b]) / length - 1));
        }
    return worst;
}

std::vector<Planar> dome_guess(const Mesh& mesh) {
    std::vector<Vec3d> points;
    for (const auto& x : mesh.vertices) points.push_back(cast<double>(x));
    const RootDome dome = dome_of(points);
    std::vector<Planar> guess;
    for (const auto& x : points) guess.push_back(dome.project(x));
    return guess;
}

Mesh half_cylinder() {
    return lattice_mesh(20, 12, [](double i, double j) {
        const double a = pi * i / 19;
        return Vec3d{0.1 * std::cos(a), 0.1 * std::sin(a), 0.02 * j};
    });
}
Mesh cone_part() {
    return lattice_mesh(20, 10, [](double i, double j) {
        const double a = 1.8 * i / 19, r = 0.03 + 0.01 * j;
        return Vec3d{r * std::cos(a), -0.8 * r, r * std::sin(a)};
    });
}
Mesh cap_mesh(double coverage) {
    Mesh ball = triangulated(Sphere{0.1}, 48), cap{ball.vertices, {}};
    std::vector<int> chosen;
    for (size_t t = 0; t < ball.triangles.size(); ++t)
        if (std::all_of(ball.triangles[t].begin(), ball.triangles[t].end(),
                        [&](int v) { return double(ball.vertices[size_t(v)].y) > 0.1 * std::cos(coverage); }))
            chosen.push_back(int(t));
    return submesh(ball, chosen);
}

TEST(Arap, a_developable_patch_is_laid_flat_without_stretching) {
    for (const Mesh& mesh : {half_cylinder(), cone_part()}) {
        const auto guess = dome_guess(mesh);
        EXPECT_GT(worst_edge_error(mesh, guess), 0.05);  // the guess does stretch
        const Flattening flat = flatten_arap(mesh, guess);
        // Vertices are single precision: 6e-8 of 0.1 m against edges of 5 mm is 1e-6; the iteration stops
        // near that.
        EXPECT_LT(worst_edge_error(mesh, flat.place), 1e-5);
        EXPECT_LT(flat.distortion, 1e-5);
        EXPECT_EQ(flat.flipped, 0);
    }
}

TEST(Arap, turning_the_triangles_round_mirrors_nothing) {
    Mesh mesh = cap_mesh(1.2);
    const auto guess = dome_guess(mesh);
    const Flattening flat = flatten_arap(mesh, guess);
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    const Flattening turned = flatten_arap(mesh, guess);
    EXPECT_EQ(flat.flipped + turned.flipped, 0);
    for (size_t v = 0; v < guess.size(); ++v) EXPECT_LT(norm(flat.place[v] - turned.place[v]), 1e-9);
}

TEST(Arap, a_cap_cannot_be_flat_but_ends_less_distorted_than_by_projection) {
    const Mesh mesh = cap_mesh(1.5);
    const auto guess = dome_guess(mesh);
    const Flattening flat = flatten_arap(mesh, guess);
    EXPECT_GT(flat.distortion, 0.02);
    EXPECT_LT(flat.distortion, 0.2);
    // Projection stretches the rim of a half ball by pi / 2; ARAP shares that out.
    EXPECT_LT(worst_edge_error(mesh, flat.place), 0.75 * worst_edge_error(mesh, guess));
    EXPECT_EQ(flat.flipped, 0);
}

TEST(Arap, slivers_and_folds_in_the_guess_do_no_harm) {
    Mesh mesh = half_cylinder();
    mesh.vertices[25] = mesh.vertices[26] + Vec3f{1e-7f, 0, 0};
    auto guess = dome_guess(mesh);
    for (size_t v = 100; v < 103; ++v) guess[v] = guess[v] + Planar{0.03, -0.02};
    const Flattening flat = flatten_arap(mesh, guess);
    EXPECT_EQ(flat.flipped, 0);
    EXPECT_LT(flat.distortion, 0.2);
    expect_error([&] { flatten_arap(mesh, std::vector<Planar>(3)); }, {"3 places"});
}

TEST(RootGrid, over_a_scalp_mesh_roots_keep_their_neighbours_and_stand_where_the_mesh_is) {
    // Wider than a half ball, triangles turned inward, roots a little under the surface, some of them off its
    // rim.
    Mesh mesh = triangulated(Sphere{0.1}, 48);
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    const ScalpMesh scalp(mesh);
    auto roots = cap_roots(1500, {0, 1, 0}, 1.9);
    for (auto& x : roots) x = 0.96 * x;
    std::string how;
    const auto places = parameterised(roots, &scalp, &how);
    EXPECT_NE(how.find("0 turned over"), std::string::npos) << how;
    // Near pairs stay near, in the mean, and none is torn apart.
    double sum = 0, worst = 0;
    int pairs = 0;
    for (size_t i = 0; i < roots.size(); ++i)
        for (size_t j = 0; j < i; ++j)
            if (const double away = norm(roots[i] - roots[j]); away < 0.01 && away > 0.005) {
                const double ratio = norm(places[i] - places[j]) / away;
                sum += ratio;
                worst = std::max(worst, ratio);
                ++pairs;
            }
    ASSERT_GT(pairs, 1000);
    EXPECT_NEAR(sum / pairs, 1.04, 0.15);
    EXPECT_LT(worst, 2.5);
    EXPECT_LT(lay_on_grid(roots, &scalp).quality.ratio(), 3.2);
}

TEST(ScalpMesh, normals_point_outward_and_depth_has_a_sign_whichever_way_triangles_turn) {
    for (bool inward : {false, true}) {
        Mesh mesh = triangulated(Sphere{0.1}, 64);
        if (inward)
            for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
        const ScalpMesh scalp(mesh);
        Random random(4);
        for (int i = 0; i < 200; ++i) {
            const Vec3d d = random.direction();
            const double height = random.number(-0.03, 0.05);
            const ScalpPoint p = scalp.closest((0.1 + height) * d);
            EXPECT_GT(dot(p.normal, d), 0.995);
            EXPECT_NEAR(p.height, height, 3e-4);
        }
    }
}

}  // namespace
}  // namespace wetcurl
