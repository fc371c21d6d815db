// Parts of the program that `wetcurl bench` times on the CPU. Level sets: the paper, VI.B; neighbour search:
// its Table 4.
#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <memory>
#include <numbers>
#include <random>
#ifdef WETCURL_HAVE_NANOFLANN
#include <nanoflann.hpp>
#endif

#include "app/bench/bench.h"
#include "base/geometry/neighbor_list.h"
#include "solver/solids/solid_tree.h"

namespace wetcurl::bench {

namespace {

Entry timed(const Line& line, const std::function<std::function<void()>()>& prepare) {
    auto measure = [line, prepare](Results& out) {
        out.lines.push_back(line);
        out.lines.back().seconds = repeated(prepare);
    };
    return {{line.name}, line.series, measure};
}

// --- level sets

constexpr double sphere_radius = 0.1;

Mesh sphere_mesh() { return triangulated(Sphere{sphere_radius}, 64); }  // 3968 triangles

// Level set of a sphere, so many cells across.
Entry level_set_build(int cells) {
    const double nodes = std::pow(cells + 9, 3);
    const Line line{fmt::format("level set build {}³", cells),
                    "level set build",
                    std::pow(cells, 3),
                    "node",
                    nodes,
                    nodes * sizeof(float)};
    return timed(line, [cells] {
        return [mesh = sphere_mesh(), cells] { LevelSet(mesh, 2 * sphere_radius / cells); };
    });
}

// The same for a sphere that breathes, rebuilt in its band.
Entry level_set_rebuild(int cells) {
    const double nodes = std::pow(std::ceil((cells + 8) / 8.0) * 8 + 1, 3);
    const Line line{
        fmt::format("level set rebuild {}³", cells), "level set rebuild", std::pow(cells, 3), "node", nodes,
        nodes * (2 * sizeof(float) + sizeof(Vec3f))};
    return timed(line, [cells] {
        const Mesh mesh = sphere_mesh();
        auto level_set =
            std::make_shared<MovingLevelSet>(mesh, bounding_box(mesh), 2 * sphere_radius / cells, 0);
        auto small = mesh.vertices;
        for (auto& v : small) v = 0.98f * v;
        return [level_set, large = mesh.vertices, small, in = false]() mutable {
            in = !in;
            level_set->advance(in ? small : large, 1.0 / 24);
        };
    });
}

// Solids of one shape on the corners of a lattice, and strands through all of it.
struct Queries {
    using S = Pack<float>;
    std::vector<Shape> shapes;
    std::vector<PosedSolid<float>> solids;
    SolidTree<float> tree;
    std::vector<Vec3<S>> x, normal, velocity;
    std::vector<S> phi;

    static constexpr size_t packs = 2000;  // 32000 particles

    Queries(const Shape& shape, int count)
        : shapes(size_t(count), shape), normal(packs), velocity(packs), phi(packs) {
        const int side = int(std::ceil(std::cbrt(double(count)) - 1e-9));
        for (int k = 0; k < count; ++k)
            solids.push_back({&shapes[size_t(k)],
                              Quatf::identity(),
                              0.3f * Vec3f{float(k % side), float(k / side % side), float(k / side / side)},
                              {0, 0, 0},
                              {0, 0, 0},
                              0.3f,
                              false});
        tree.pose(solids);
        std::mt19937 random(1);
        const auto number = [&](double size) { return float(size * (double(random()) / 4294967296.0)); };
        for (size_t k = 0; k < packs; ++k) {
            // Lanes are strands side by side.
            const float span = 0.3f * float(side);
            const Vec3f at{number(span) - 0.15f, number(span) - 0.15f, number(span) - 0.15f};
            Vec3<S> lanes;
            for (int lane = 0; lane < S::lanes; ++lane) {
                lanes.x.set(lane, at.x + number(0.02));
                lanes.y.set(lane, at.y + number(0.02));
                lanes.z.set(lane, at.z + number(0.02));
            }
            x.push_back(lanes);
        }
    }
};

// The nearest of so many solids at every particle, on one thread: what a block of strands pays.
Entry query(const std::string& shape_name, const std::function<Shape()>& shape, int count, bool by_tree) {
    const std::string series = fmt::format("{} query by {}", shape_name, by_tree ? "tree" : "loop");
    const Line line{fmt::format("{}, {} solids", series, count),
                    series,
                    double(count),
                    "particle",
                    double(Queries::packs * Queries::S::lanes),
                    double(Queries::packs * 10 * sizeof(Queries::S))};
    return timed(line, [shape, count, by_tree] {
        auto q = std::make_shared<Queries>(shape(), count);
        return [q, by_tree] {
            for (size_t k = 0; k < Queries::packs; ++k)
                if (by_tree)
                    sample_nearest(q->tree, q->solids, q->x[k], q->phi[k], q->normal[k], q->velocity[k]);
                else
                    sample_nearest(q->solids, q->x[k], q->phi[k], q->normal[k], q->velocity[k]);
        };
    });
}
Shape small_sphere() { return Sphere{sphere_radius}; }
Shape small_level_set() { return std::make_shared<const LevelSet>(sphere_mesh(), 2 * sphere_radius / 32); }

// --- neighbour search, Table 4

constexpr double neighbours_wanted = 30;

// Points in a unit cube, and the radius that gives each about 30 neighbours.
struct Cloud {
    std::vector<Vec3f> points;
    float radius;
    explicit Cloud(size_t count)
        : radius(float(std::cbrt(neighbours_wanted / (4.0 / 3 * std::numbers::pi * double(count))))) {
        std::mt19937 random(2);
        const auto number = [&] { return float(double(random()) / 4294967296.0); };
        for (size_t k = 0; k < count; ++k) {
            const float x = number(), y = number();
            points.push_back({x, y, number()});
        }
    }
};

// Every way counts the neighbours of every point; a thread writes its own points' numbers.
using Search = std::function<void(const Cloud&, std::vector<uint32_t>&)>;

void by_brute_force(const Cloud& cloud, std::vector<uint32_t>& count) {
    const float reach = cloud.radius * cloud.radius;
#pragma omp parallel for schedule(static)
    for (size_t i = 0; i < cloud.points.size(); ++i) {
        uint32_t found = 0;
        for (const Vec3f& p : cloud.points) {
            const Vec3f d = p - cloud.points[i];
            found += dot(d, d) < reach;
        }
        count[i] = found - 1;
    }
}

// As a simulation does it each frame, with the memory of the frame before.
struct ByGrid {
    NeighborGrid grid;
    NeighborList list;
    std::vector<float> source;

    void operator()(const Cloud& cloud, std::vector<uint32_t>& count) {
        const size_t n = cloud.points.size(), padded = n + NeighborList::padding;
        grid.build(cloud.points.data(), n, cloud.radius);
        source.assign(padded, 1.f);
        for (size_t k = 0; k < n; ++k) grid.points().set_group(k, uint32_t(k));
        list.build(grid, source, cloud.radius);
#pragma omp parallel for schedule(static)
        for (size_t c = 0; c < list.clusters(); ++c) {
            uint32_t found[NeighborList::cluster]{};
            list.visit_runs(c, [&](size_t, uint32_t bits) {
                for (uint32_t& of : found) of += uint32_t(std::popcount(bits & 15)), bits >>= 4;
            });
            for (size_t i = 0, k = c * NeighborList::cluster; k < n && i < NeighborList::cluster; ++i, ++k)
                count[grid.order()[k]] = found[i];
        }
    }
};

#ifdef WETCURL_HAVE_NANOFLANN
// The points as nanoflann asks for them.
struct CloudAdaptor {
    const Cloud& cloud;
    size_t kdtree_get_point_count() const { return cloud.points.size(); }
    float kdtree_get_pt(size_t k, size_t axis) const {
        const Vec3f& p = cloud.points[k];
        return axis == 0 ? p.x : axis == 1 ? p.y : p.z;
    }
    template <class Box>
    bool kdtree_get_bbox(Box&) const {
        return false;
    }
};
void by_kd_tree(const Cloud& cloud, std::vector<uint32_t>& count) {
    using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, CloudAdaptor>,
                                                     CloudAdaptor, 3, uint32_t>;
    const CloudAdaptor points{cloud};
    Tree tree(3, points, nanoflann::KDTreeSingleIndexAdaptorParams(16));
    tree.buildIndex();
    nanoflann::SearchParams unsorted;
    unsorted.sorted = false;
#pragma omp parallel
    {
        std::vector<std::pair<uint32_t, float>> found;
#pragma omp for schedule(dynamic, 512)
        for (size_t i = 0; i < cloud.points.size(); ++i)
            count[i] = uint32_t(
                tree.radiusSearch(&cloud.points[i].x, cloud.radius * cloud.radius, found, unsorted) - 1);
    }
}
const Search kd_tree = by_kd_tree;
const char* const kd_tree_absent = "";
#else
const Search kd_tree;
const char* const kd_tree_absent = "built without nanoflann (libnanoflann-dev; scripts/setup installs it)";
#endif

Entry neighbour_search(const char* way, const Search& search, size_t count, const char* absent = "") {
    const std::string series = fmt::format("neighbour search by {}", way);
    const Line line{fmt::format("{}, {}", series, count),
                    series,
                    double(count),
                    "particle",
                    double(count),
                    double(count * (sizeof(Vec3f) + sizeof(uint32_t)))};
    if (!search) return {{line.name}, series, {}, absent};
    return timed(line, [search, count] {
        auto cloud = std::make_shared<const Cloud>(count);
        return [cloud, search, found = std::vector<uint32_t>(count)]() mutable { search(*cloud, found); };
    });
}

// --- the list

}  // namespace

std::vector<Entry> part_entries() {
    std::vector<Entry> all;
    for (int cells : {16, 32, 64, 128}) all.push_back(level_set_build(cells));
    for (int cells : {16, 32, 64, 128}) all.push_back(level_set_rebuild(cells));
    for (bool by_tree : {false, true})
        for (int count : {1, 2, 4, 8, 16, 32, 64})
            all.push_back(query("level set", small_level_set, count, by_tree));
    for (bool by_tree : {false, true})
        for (int count : {1, 2, 4, 8, 16, 32, 64})
            all.push_back(query("sphere", small_sphere, count, by_tree));
    for (size_t count : {1000, 4000, 16000, 64000})
        all.push_back(neighbour_search("brute force", by_brute_force, count));
    for (size_t count : {1000, 10000, 100000, 1000000})
        all.push_back(neighbour_search("k-d tree", kd_tree, count, kd_tree_absent));
    for (size_t count : {1000, 10000, 100000, 1000000})
        all.push_back(neighbour_search("grid", ByGrid(), count));
    return all;
}

}  // namespace wetcurl::bench
