// `wetcurl bench`: the parts of the program timed on this machine, as a table and as JSON. An entry is a line
// of the list at the end. Level sets: the paper, VI.B; neighbour search: its Table 4.
#include <fmt/format.h>
#include <omp.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <random>
#ifdef WETCURL_HAVE_NANOFLANN
#include <nanoflann.hpp>
#endif

#include "app/commands.h"
#include "app/results.h"
#include "base/geometry/neighbor_list.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "solver/passes/solid_tree.h"

namespace wetcurl {

namespace {

// --- what an entry is

// One measurement. What `prepare` returns is timed.
struct Entry {
    std::string name;
    std::string series;  // entries over which an exponent of time in `size` is fitted; "": none
    double size = 0;
    std::string item;  // a repetition works on `items` of them
    double items = 0;
    size_t bytes = 0;                                // that a repetition reads or writes at least, once
    std::function<std::function<void()>()> prepare;  // null: not in this build, `absent` says why
    std::string absent = "";
};

struct Measured {
    const Entry* entry;
    double median, min, max;  // [s]
};

// Repetitions until they have taken `budget` [s], or one that takes far longer.
constexpr double budget = 0.5;
constexpr size_t fewest = 3, most = 200;

Measured measure(const Entry& entry) {
    const auto act = entry.prepare();
    const auto timed = [&] {
        const double begin = omp_get_wtime();
        act();
        return omp_get_wtime() - begin;
    };
    std::vector<double> seconds{timed()};
    double spent = seconds[0];
    // The first one warms up and counts only where it is long.
    if (spent < 2 * budget) seconds.clear();
    while (spent < 4 * budget && seconds.size() < most && (seconds.size() < fewest || spent < budget)) {
        seconds.push_back(timed());
        spent += seconds.back();
    }
    std::sort(seconds.begin(), seconds.end());
    const size_t n = seconds.size();
    return {&entry, 0.5 * (seconds[(n - 1) / 2] + seconds[n / 2]), seconds.front(), seconds.back()};
}

// --- the machine

// Bytes a second, read and written, of a copy far larger than any cache by all threads.
double copy_bandwidth() {
    constexpr size_t chunk = size_t(1) << 20, chunks = 128;
    std::vector<char> from(chunk * chunks, 1), to(chunk * chunks);
    Entry copy;
    copy.prepare = [&] {
        return [&] {
#pragma omp parallel for schedule(static)
            for (size_t c = 0; c < chunks; ++c) std::memcpy(&to[c * chunk], &from[c * chunk], chunk);
        };
    };
    return 2.0 * double(from.size()) / measure(copy).min;
}

std::string processor() {
    std::ifstream in("/proc/cpuinfo");
    for (std::string line; std::getline(in, line);)
        if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
    return "unknown";
}

// Of this process so far; 0 where the system does not say.
size_t peak_bytes() {
    std::ifstream in("/proc/self/status");
    for (std::string line; std::getline(in, line);)
        if (line.rfind("VmHWM:", 0) == 0) return size_t(std::stod(line.substr(6)) * 1024);
    return 0;
}

// --- level sets

constexpr double sphere_radius = 0.1;

Mesh sphere_mesh() { return triangulated(Sphere{sphere_radius}, 64); }  // 3968 triangles

// Level set of a sphere, so many cells across.
Entry level_set_build(int cells) {
    const double nodes = std::pow(cells + 9, 3);
    Entry entry{fmt::format("level set build {}³", cells),
                "level set build",
                std::pow(cells, 3),
                "node",
                nodes,
                size_t(nodes) * sizeof(float),
                {}};
    entry.prepare = [cells] {
        return [mesh = sphere_mesh(), cells] { LevelSet(mesh, 2 * sphere_radius / cells); };
    };
    return entry;
}

// The same for a sphere that breathes, rebuilt in its band.
Entry level_set_rebuild(int cells) {
    const double nodes = std::pow(std::ceil((cells + 8) / 8.0) * 8 + 1, 3);
    Entry entry{fmt::format("level set rebuild {}³", cells),
                "level set rebuild",
                std::pow(cells, 3),
                "node",
                nodes,
                size_t(nodes) * (2 * sizeof(float) + sizeof(Vec3f)),
                {}};
    entry.prepare = [cells] {
        const Mesh mesh = sphere_mesh();
        auto level_set =
            std::make_shared<MovingLevelSet>(mesh, bounding_box(mesh), 2 * sphere_radius / cells, 0);
        auto small = mesh.vertices;
        for (auto& v : small) v = 0.98f * v;
        return [level_set, large = mesh.vertices, small, in = false]() mutable {
            in = !in;
            level_set->advance(in ? small : large, 1.0 / 24);
        };
    };
    return entry;
}

// Solids of one shape on the corners of a lattice, and strands through all of it.
struct Queries {
    using S = Pack<float>;
    std::vector<Shape> shapes;
    std::vector<PosedSolid<float>> solids;
    std::optional<SolidTree<float>> tree;
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
        tree.emplace(solids);
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
    Entry entry{fmt::format("{}, {} solids", series, count),
                series,
                double(count),
                "particle",
                double(Queries::packs * Queries::S::lanes),
                Queries::packs * 10 * sizeof(Queries::S),
                {}};
    entry.prepare = [shape, count, by_tree] {
        auto q = std::make_shared<Queries>(shape(), count);
        return [q, by_tree] {
            for (size_t k = 0; k < Queries::packs; ++k)
                if (by_tree)
                    sample_nearest(*q->tree, q->solids, q->x[k], q->phi[k], q->normal[k], q->velocity[k]);
                else
                    sample_nearest(q->solids, q->x[k], q->phi[k], q->normal[k], q->velocity[k]);
        };
    };
    return entry;
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

void by_grid(const Cloud& cloud, std::vector<uint32_t>& count) {
    const size_t n = cloud.points.size(), padded = n + NeighborList::lanes;
    NeighborGrid grid;
    grid.build(cloud.points.data(), n, cloud.radius);
    std::vector<uint32_t> group(padded);
    for (size_t k = 0; k < n; ++k) group[k] = uint32_t(k);
    NeighborList list;
    list.build(grid, group, std::vector<float>(padded, 1.f), cloud.radius);
#pragma omp parallel for schedule(static)
    for (size_t k = 0; k < n; ++k) {
        uint32_t found = 0;
        list.visit_runs(k, [&](uint32_t, uint32_t bits) { found += uint32_t(std::popcount(bits)); });
        count[grid.order()[k]] = found;
    }
}

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
    Entry entry{fmt::format("{}, {}", series, count),       series, double(count), "particle", double(count),
                count * (sizeof(Vec3f) + sizeof(uint32_t)), {},     absent};
    if (search)
        entry.prepare = [search, count] {
            auto cloud = std::make_shared<const Cloud>(count);
            return [cloud, search, found = std::vector<uint32_t>(count)]() mutable { search(*cloud, found); };
        };
    return entry;
}

// --- the list

std::vector<Entry> entries() {
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
        all.push_back(neighbour_search("grid", by_grid, count));
    return all;
}

// --- results

// Slope of log time over log size by least squares; of the shortest times, which other programs' load and
// the threads' waiting for one another hardly reach.
double exponent(const std::vector<Measured>& series) {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (const auto& m : series) {
        const double x = std::log(m.entry->size), y = std::log(m.min);
        ++n, sx += x, sy += y, sxx += x * x, sxy += x * y;
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

std::string with_unit(double a, const char* unit) {
    const char* prefixes[] = {"", "k", "M", "G", "T"};
    int k = 0;
    for (; a >= 999.5 && k < 4; ++k) a /= 1000;
    return fmt::format("{:.3g} {}{}", a, prefixes[k], unit);
}

double share_of_copy(const Measured& m, double bandwidth) {
    return double(m.entry->bytes) / m.median / bandwidth;
}

Json json_of(const Measured& m, double bandwidth) {
    const Entry& e = *m.entry;
    return {{"name", e.name},
            {"device", "cpu"},
            {"strands", nullptr},
            {"particles_per_strand", nullptr},
            {"milliseconds", {{"median", 1e3 * m.median}, {"min", 1e3 * m.min}, {"max", 1e3 * m.max}}},
            {"bytes", e.bytes},
            {"items", e.items},
            {"items_per_second", e.items / m.median},
            {"share_of_copy_bandwidth", share_of_copy(m, bandwidth)}};
}

void print_row(const Measured& m, double bandwidth) {
    const Entry& e = *m.entry;
    fmt::print("{:42} {:>10.3f} {:>10.3f} {:>10.3f}  {:>20}  {:>7.2g} %\n", e.name, 1e3 * m.median,
               1e3 * m.min, 1e3 * m.max, with_unit(e.items / m.median, (e.item + "s/s").c_str()),
               100 * share_of_copy(m, bandwidth));
    std::fflush(stdout);
}

}  // namespace

int bench_command(const BenchOptions& o) {
    refuse_scene_options(o, "bench");
    refuse_device(o, "bench");
    check_files(o, "", {});
    std::vector<Entry> chosen;
    for (auto& entry : entries())
        if (entry.name.find(o.filter) != std::string::npos) chosen.push_back(entry);
    if (chosen.empty()) {
        std::string known;
        for (const auto& entry : entries())
            if (known.find(entry.series) == std::string::npos)
                known += (known.empty() ? "" : ", ") + entry.series;
        throw Misuse("--filter: no entry's name holds '" + o.filter + "'; there are " + known);
    }
    const bool table = o.json != "-";
    const double bandwidth = copy_bandwidth();
    Json json{{"machine",
               {{"processor", processor()},
                {"threads", omp_get_max_threads()},
                {"lanes", Pack<float>::lanes},
                {"copy_bytes_per_second", bandwidth}}},
              {"entries", Json::array()},
              {"fits", Json::array()}};
    if (table)
        fmt::print("{}, {} threads, copies {}\n\n{:42} {:>10} {:>10} {:>10}  {:>20}  {:>9}\n", processor(),
                   omp_get_max_threads(), with_unit(bandwidth, "B/s"), "[ms]", "median", "min", "max", "",
                   "of a copy");
    InterruptGuard guard;
    std::vector<Measured> measured;
    std::string told;
    for (const Entry& entry : chosen) {
        if (guard.asked()) throw Interrupted("interrupted: nothing is kept of the measurements");
        if (!entry.prepare) {
            if (told != entry.absent) log_info(entry.series + ": " + entry.absent);
            told = entry.absent;
            continue;
        }
        measured.push_back(measure(entry));
        json["entries"].push_back(json_of(measured.back(), bandwidth));
        if (table) print_row(measured.back(), bandwidth);
    }
    if (table) fmt::print("\n");
    for (size_t first = 0, end; first < measured.size(); first = end) {
        for (end = first;
             end < measured.size() && measured[end].entry->series == measured[first].entry->series;)
            ++end;
        if (end - first < 3) continue;
        const std::vector<Measured> series(measured.begin() + long(first), measured.begin() + long(end));
        const double slope = exponent(series);
        json["fits"].push_back({{"name", series[0].entry->series}, {"exponent", slope}});
        if (table) fmt::print("{:42} time ~ size^{:.2f}\n", series[0].entry->series, slope);
    }
    json["machine"]["peak_bytes"] = peak_bytes();
    write_json(json, o.json);
    return 0;
}

}  // namespace wetcurl
