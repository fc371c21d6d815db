// Roots to plane to pixels.
#include "solver/grooms/root_grid.h"

#include <algorithm>
#include <climits>
#include <cstdio>
#include <Eigen/Dense>
#include <numeric>

#include "base/error.h"
#include "solver/grooms/flatten.h"
#include "solver/grooms/nearest.h"

namespace wetcurl {

GridSize finest_grid(int roots) {
    for (int unit : {8, 4, 2, 1}) {
        GridSize best{0, 0};
        int fewest = INT_MAX;  // holes
        for (int height = unit; (height - unit) * (height - unit) <= roots; height += unit)
            for (int width = height; width <= 1.5 * height + 1; width += unit) {
                const int holes = width * height - roots;
                if (holes < 0 || holes > most_holes({width, height}) || (unit > 1 && holes > 0.125 * roots))
                    continue;
                if (holes < fewest) best = {width, height}, fewest = holes;
                break;
            }
        if (fewest < INT_MAX) return best;
    }
    return {0, 0};
}

int most_holes(GridSize size) { return (size.width / 2) * (size.height / 2); }

// One flag a pixel: `holes` of those in odd columns of odd rows, spread evenly among them.
static std::vector<char> holes_of(GridSize size, int holes) {
    std::vector<char> out(size_t(size.width) * size_t(size.height), 0);
    const int places = most_holes(size), columns = size.width / 2;
    for (int k = 0; k < holes; ++k) {
        const int place = int((2LL * k + 1) * places / (2 * holes));
        out[size_t(2 * (place / columns) + 1) * size_t(size.width) + size_t(2 * (place % columns) + 1)] = 1;
    }
    return out;
}

// ---- roots to plane

static Vec3d mean_of(const std::vector<Vec3d>& points) {
    Vec3d sum{0, 0, 0};
    for (const auto& x : points) sum += x;
    return (1.0 / double(points.size())) * sum;
}

RootDome dome_of(const std::vector<Vec3d>& roots) {
    const Vec3d mean = mean_of(roots);
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    Eigen::Vector3d pull = Eigen::Vector3d::Zero();
    double square = 0;
    for (const auto& x : roots) {
        const Vec3d d = x - mean;
        const Eigen::Vector3d e(d.x, d.y, d.z);
        spread += e * e.transpose();
        pull += dot(d, d) * e;
        square += dot(d, d) / double(roots.size());
    }
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
    auto axis = [&](int k) {
        return Vec3d{axes.eigenvectors()(0, k), axes.eigenvectors()(1, k), axes.eigenvectors()(2, k)};
    };
    RootDome dome;
    // Under a hundredth as thick as it is wide, or all but a line, there is no sphere to be found in it.
    const Eigen::Vector3d squares = axes.eigenvalues();
    dome.flat = squares[0] <= 1e-4 * squares[1] || squares[1] <= 1e-6 * squares[2];
    if (dome.flat) {
        dome.centre = mean;
        dome.axis = axis(0).y < 0 ? -axis(0) : axis(0);
    } else {
        // The sphere |d|^2 = 2 c.d + k through the roots, d = x - mean: 2 sum(d d^T) c = sum(|d|^2 d), k =
        // mean |d|^2.
        const Eigen::Vector3d fit = 0.5 * spread.ldlt().solve(pull);
        const Vec3d c{fit[0], fit[1], fit[2]};
        dome.centre = mean + c;
        dome.radius = std::sqrt(square + dot(c, c));
        dome.axis = normalized(-c, Vec3d{0, 1, 0});
    }
    const Vec3d x_axis{1, 0, 0}, z_axis{0, 0, 1};
    const Vec3d across = std::abs(dome.axis.x) < 0.9 ? x_axis : z_axis;
    dome.right = normalized(across - dot(across, dome.axis) * dome.axis, z_axis);
    return dome;
}

Vec3d RootDome::outward(const Vec3d& x) const { return flat ? axis : normalized(x - centre, axis); }

Planar RootDome::project(const Vec3d& x) const {
    const Vec3d d = x - centre, up = cross(axis, right);
    const Planar flat_place{dot(d, right), dot(d, up)};
    if (flat) return flat_place;
    const double across = norm(flat_place), angle = std::atan2(across, dot(d, axis));
    return across > 0 ? (radius * angle / across) * flat_place : Planar{0, 0};
}

namespace {

// The part of the scalp under the roots: triangles whose middle is near a root, grown to a disk; more and
// more of them until nearly every root stands on it.
std::vector<int> patch_under(const ScalpMesh& scalp, const std::vector<Vec3d>& feet,
                             const std::vector<int>& under) {
    const Mesh& mesh = scalp.mesh();
    const NearestPoint nearest(feet);
    std::vector<double> away(mesh.triangles.size());
    const Bounds box = bounding_box(mesh);
    const double whole = norm(box.high - box.low);
    double spacing = 0;
    for (size_t i = 0; i < feet.size(); ++i)
        spacing += std::min(whole, nearest.distance(feet[i], int(i))) / double(feet.size());
    const Vec3d middle = mean_of(feet);
    double best = whole;
    int seed = under[0];
    for (size_t t = 0; t < away.size(); ++t) {
        const auto& c = mesh.triangles[t];
        const Vec3d a = cast<double>(mesh.vertices[size_t(c[0])]),
                    b = cast<double>(mesh.vertices[size_t(c[1])]),
                    d = cast<double>(mesh.vertices[size_t(c[2])]), centre = (1.0 / 3) * (a + b + d);
        // A triangle larger than the gaps between roots counts from its rim.
        away[t] = nearest.distance(centre) - norm(a - centre);
    }
    for (int t : under) {
        const Vec3d at = cast<double>(mesh.vertices[size_t(mesh.triangles[size_t(t)][0])]);
        if (const double d = norm(at - middle); d < best) best = d, seed = t;
    }
    for (double margin = 4 * spacing;; margin *= 2) {
        std::vector<char> allowed(away.size());
        for (size_t t = 0; t < away.size(); ++t) allowed[t] = away[t] < margin;
        const std::vector<int> disk = disk_of_triangles(mesh, allowed, seed);
        std::vector<char> inside(away.size(), 0);
        for (int t : disk) inside[size_t(t)] = 1;
        const auto held =
            std::count_if(under.begin(), under.end(), [&](int t) { return inside[size_t(t)] != 0; });
        if (double(held) >= 0.98 * double(under.size()) || margin > whole || spacing == 0) return disk;
    }
}

}  // namespace

std::vector<Planar> parameterised(const std::vector<Vec3d>& roots, const ScalpMesh* scalp, std::string* how) {
    std::vector<Planar> places;
    const RootDome dome = dome_of(roots);
    if (!scalp) {
        for (const auto& x : roots) places.push_back(dome.project(x));
        if (how) *how = dome.flat ? "projected on their plane" : "azimuthal equal-distance projection";
        return places;
    }
    std::vector<Vec3d> feet;
    std::vector<int> under;
    for (const auto& x : roots) {
        const auto closest = scalp->distance().closest(x);
        feet.push_back(closest.point);
        under.push_back(closest.triangle);
    }
    const Mesh patch = submesh(scalp->mesh(), patch_under(*scalp, feet, under));
    std::vector<Planar> guess;
    for (const auto& x : patch.vertices) guess.push_back(dome.project(cast<double>(x)));
    const Flattening flat = flatten_arap(patch, guess);
    const MeshDistance on_patch(patch);
    for (const auto& foot : feet) {
        const auto at = on_patch.closest(foot);
        const auto& c = patch.triangles[size_t(at.triangle)];
        const Vec3d w = at.barycentric;
        places.push_back(w.x * flat.place[size_t(c[0])] + w.y * flat.place[size_t(c[1])] +
                         w.z * flat.place[size_t(c[2])]);
    }
    if (how) {
        char text[160];
        std::snprintf(text, sizeof text,
                      "ARAP of %zu scalp triangles, distortion %.1f %%, %d turned over, %d iterations",
                      patch.triangles.size(), 100 * flat.distortion, flat.flipped, flat.iterations);
        *how = text;
    }
    return places;
}

// ---- places to pixels

namespace {

// Cuts pixels and roots in the same proportion, until a pixel is left alone with its roots.
class Cutter {
  public:
    Cutter(const std::vector<Planar>& places, GridSize size, Cuts cuts)
        : places_(places), cuts_(cuts), order_(places.size()), grid_{size.width, size.height, {}} {
        std::iota(order_.begin(), order_.end(), 0);
        const int pixels = size.width * size.height;
        grid_.strand.assign(size_t(pixels), -1);
        const auto hole = holes_of(size, std::max(0, pixels - int(places.size())));
        filled_.assign(size_t(size.width + 1) * size_t(size.height + 1), 0);
        for (int r = 0; r < size.height; ++r)
            for (int c = 0; c < size.width; ++c)
                filled(c + 1, r + 1) = filled(c, r + 1) + filled(c + 1, r) - filled(c, r) +
                                       !hole[size_t(r) * size_t(size.width) + size_t(c)];
    }
    RootGrid run() {
        cut({0, grid_.width, 0, grid_.height, 0, int(order_.size())});
        return grid_;
    }

  private:
    // Columns [c0, c1), rows [r0, r1), and their roots order_[first, last).
    struct Block {
        int c0, c1, r0, r1, first, last;
    };
    // Pixels in the columns before `c` of the rows before `r` that hold a root.
    int& filled(int c, int r) { return filled_[size_t(r) * size_t(grid_.width + 1) + size_t(c)]; }
    int pixels(const Block& b) {
        return filled(b.c1, b.r1) - filled(b.c0, b.r1) - filled(b.c1, b.r0) + filled(b.c0, b.r0);
    }
    double key(int root, bool by_column) const {
        return by_column ? places_[size_t(root)].x : places_[size_t(root)].y;
    }
    void cut(const Block& block);
    int middlemost(const Block& block) const;

    const std::vector<Planar>& places_;
    Cuts cuts_;
    std::vector<int> order_;
    RootGrid grid_;
    std::vector<int> filled_;  // (row, column)
};

// The root nearest to the mean of those that share a pixel.
int Cutter::middlemost(const Block& block) const {
    Planar mean{0, 0};
    for (int k = block.first; k < block.last; ++k)
        mean = mean + (1.0 / (block.last - block.first)) * places_[size_t(order_[size_t(k)])];
    return *std::min_element(order_.begin() + block.first, order_.begin() + block.last, [&](int a, int b) {
        return std::pair(norm(places_[size_t(a)] - mean), a) < std::pair(norm(places_[size_t(b)] - mean), b);
    });
}

void Cutter::cut(const Block& block) {
    if (block.first == block.last) return;  // holes
    if (block.c1 - block.c0 == 1 && block.r1 - block.r0 == 1) {
        grid_.strand[size_t(block.r0) * size_t(grid_.width) + size_t(block.c0)] = middlemost(block);
        return;
    }
    const int columns = block.c1 - block.c0, rows = block.r1 - block.r0;
    const bool by_column = cuts_ == Cuts::rows_first ? rows == 1 : columns >= rows;
    Block low = block, high = block;
    if (by_column)
        low.c1 = high.c0 = block.c0 + columns / 2;
    else
        low.r1 = high.r0 = block.r0 + rows / 2;
    const int roots = block.last - block.first;
    const int share = std::clamp(int(std::lround(double(roots) * pixels(low) / pixels(block))), pixels(low),
                                 roots - pixels(high));
    low.last = high.first = block.first + share;
    // Ties by index: the result does not hang on the library's sort.
    std::nth_element(
        order_.begin() + block.first, order_.begin() + low.last, order_.begin() + block.last,
        [&](int a, int b) { return std::pair(key(a, by_column), a) < std::pair(key(b, by_column), b); });
    cut(low);
    cut(high);
}

double squared(const Vec3d& a) { return dot(a, a); }

}  // namespace

RootGrid assigned(const std::vector<Planar>& places, GridSize size, Cuts cuts) {
    return Cutter(places, size, cuts).run();
}

int untangle(RootGrid& grid, const std::vector<Vec3d>& roots) {
    auto pixel = [&](int c, int r) -> int& {
        return grid.strand[size_t(r) * size_t(grid.width) + size_t(c)];
    };
    // Squared way from the root at (c, r) to its four neighbours.
    auto way = [&](int c, int r) {
        double sum = 0;
        for (auto [dc, dr] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
            if (c + dc >= 0 && c + dc < grid.width && r + dr >= 0 && r + dr < grid.height &&
                pixel(c + dc, r + dr) >= 0)
                sum += squared(roots[size_t(pixel(c, r))] - roots[size_t(pixel(c + dc, r + dr))]);
        return sum;
    };
    constexpr int most_sweeps = 50, reach = 2;
    int exchanges = 0;
    for (int sweep = 0, last = -1; sweep < most_sweeps && last != exchanges; ++sweep) {
        last = exchanges;
        for (int r = 0; r < grid.height; ++r)
            for (int c = 0; c < grid.width; ++c)
                for (int r2 = r; r2 <= std::min(r + reach, grid.height - 1); ++r2)
                    for (int c2 = std::max(0, r2 == r ? c + 1 : c - reach);
                         c2 <= std::min(c + reach, grid.width - 1); ++c2) {
                        if (pixel(c, r) < 0 || pixel(c2, r2) < 0) continue;  // holes stay where they are
                        const double before = way(c, r) + way(c2, r2);
                        std::swap(pixel(c, r), pixel(c2, r2));
                        // An edge between the two is the same either way round, and counted twice both times.
                        if (way(c, r) + way(c2, r2) < before * (1 - 1e-12))
                            ++exchanges;
                        else
                            std::swap(pixel(c, r), pixel(c2, r2));
                    }
    }
    return exchanges;
}

GridQuality grid_quality(const RootGrid& grid, const std::vector<Vec3d>& roots) {
    GridQuality quality;
    quality.roots = int(roots.size());
    std::vector<Vec3d> held;
    for (int s : grid.strand)
        if (s >= 0) held.push_back(roots[size_t(s)]);
    quality.pixels = int(held.size());
    const NearestPoint nearest(held);
    for (size_t i = 0; held.size() > 1 && i < held.size(); ++i)
        quality.nearest_mean += nearest.distance(held[i], int(i)) / double(held.size());
    double neighbours = 0;
    int pairs = 0;
    auto pair_up = [&](int a, int b) {
        if (a < 0 || b < 0) return;
        neighbours += norm(roots[size_t(a)] - roots[size_t(b)]);
        ++pairs;
    };
    for (int r = 0; r < grid.height; ++r)
        for (int c = 0; c < grid.width; ++c) {
            if (c + 1 < grid.width) pair_up(grid.at(c, r), grid.at(c + 1, r));
            if (r + 1 < grid.height) pair_up(grid.at(c, r), grid.at(c, r + 1));
        }
    if (pairs) quality.neighbour_mean = neighbours / pairs;
    return quality;
}

RootLayout lay_on_grid(const std::vector<Vec3d>& roots, const ScalpMesh* scalp, GridSize size) {
    if (roots.empty()) throw Error("a grid of roots: found no root, allowed 1 or more");
    const bool free_size = size.width == 0;
    if (free_size) size = finest_grid(int(roots.size()));
    const long long holes = (long long)size.width * size.height - (long long)roots.size();
    if (holes > most_holes(size))
        throw Error("a grid of roots: found " + std::to_string(size.width) + " x " +
                    std::to_string(size.height) + " pixels for " + std::to_string(roots.size()) +
                    " roots, allowed at most " + std::to_string(most_holes(size)) + " pixels without a root");
    RootLayout best;
    std::string how;
    const std::vector<Planar> places = parameterised(roots, scalp, &how);
    if (free_size) {
        // The longer side of the grid along the longer side of the roots.
        auto by_x = [](const Planar& a, const Planar& b) { return a.x < b.x; };
        auto by_y = [](const Planar& a, const Planar& b) { return a.y < b.y; };
        const auto [left, right] = std::minmax_element(places.begin(), places.end(), by_x);
        const auto [low, high] = std::minmax_element(places.begin(), places.end(), by_y);
        if (right->x - left->x < high->y - low->y) std::swap(size.width, size.height);
    }
    constexpr std::pair<Cuts, const char*> ways[] = {{Cuts::longer_side, "cut along the longer side"},
                                                     {Cuts::rows_first, "cut into rows first"}};
    for (const auto& [cuts, name] : ways) {
        RootLayout tried{assigned(places, size, cuts), {}, how, name};
        untangle(tried.grid, roots);
        tried.quality = grid_quality(tried.grid, roots);
        if (best.grid.strand.empty() || tried.quality.neighbour_mean < best.quality.neighbour_mean)
            best = tried;
    }
    return best;
}

std::string described(const RootLayout& layout) {
    const GridQuality& q = layout.quality;
    char text[400];
    const int holes = layout.grid.width * layout.grid.height - q.pixels;
    std::snprintf(
        text, sizeof text,
        "%d x %d pixels for %d roots (%d left out, %d pixels empty): neighbours %.2f mm apart, nearest roots "
        "%.2f mm (%.2f times); %s; %s",
        layout.grid.width, layout.grid.height, q.roots, q.roots - q.pixels, holes, 1e3 * q.neighbour_mean,
        1e3 * q.nearest_mean, q.ratio(), layout.parameterisation.c_str(), layout.assignment.c_str());
    return text;
}

}  // namespace wetcurl
