// The signed distance to a triangle mesh on a dense regular grid, made once and kept in a cache folder.
// Distance exact at every node, sign from the generalised winding number (Jacobson 2013): heads are often
// open.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "base/geometry/mesh.h"

namespace wetcurl {

// Signed distance [m], negative inside, and the unit outward normal, always finite for finite x.
template <class S>
struct DistanceSample {
    S phi;
    Vec3<S> normal;
};

// A view of nodes phi[(k * ny + j) * nx + i] at origin + spacing * (i, j, k): all that sampling needs, on any
// device.
struct DistanceGrid {
    Vec3f origin;    // [m]
    float spacing;   // [m]
    int nx, ny, nz;  // each at least 2
    const float* phi;
    WETCURL_HD float at(size_t node) const { return phi[node]; }
};

namespace detail {

// Where x falls on one axis: the lower node and the fraction beyond it, held inside the grid.
template <class S>
struct CellPlace {
    int node;
    S fraction;
};
// A node for each lane.
template <class T>
struct Nodes {
    std::array<int, size_t(Pack<T>::lanes)> of;
};
template <class T>
struct CellPlace<Pack<T>> {
    Nodes<T> node;
    Pack<T> fraction;
};
template <class T>
WETCURL_HD CellPlace<T> cell_place(T x, T origin, T per_metre, int n) {
    // minimum(maximum(NaN, 0), …) is 0: the index stays in range for any x.
    const T g = minimum(maximum((x - origin) * per_metre, T(0)), T(n - 1));
    const int node = g < T(n - 2) ? int(g) : n - 2;
    return {node, g - T(node)};
}

template <class T>
CellPlace<Pack<T>> cell_place(const Pack<T>& x, T origin, T per_metre, int n) {
    using S = Pack<T>;
    const S g = minimum(maximum((x - S(origin)) * S(per_metre), S(0)), S(n - 1)),
            lower = minimum(g, S(n - 2));
    CellPlace<S> place;
    S node;
    for (int lane = 0; lane < S::lanes; ++lane) {
        place.node.of[size_t(lane)] = int(lower.v[lane]);
        node.v[lane] = T(place.node.of[size_t(lane)]);
    }
    place.fraction = g - node;
    return place;
}

// The cell that x falls in: its lowest node, the steps to the next row and slab, the fractions beyond.
template <class S>
struct Cell {
    size_t node, row, slab;
    S u, v, w;
};
template <class T>
struct Cell<Pack<T>> {
    Nodes<T> node;
    size_t row, slab;
    Pack<T> u, v, w;
};
template <class T>
WETCURL_HD Cell<T> cell_of(const DistanceGrid& grid, const Vec3<T>& x) {
    const T per_metre = T(1) / T(grid.spacing);
    const auto [i, u] = cell_place(x.x, T(grid.origin.x), per_metre, grid.nx);
    const auto [j, v] = cell_place(x.y, T(grid.origin.y), per_metre, grid.ny);
    const auto [k, w] = cell_place(x.z, T(grid.origin.z), per_metre, grid.nz);
    const size_t row = size_t(grid.nx), slab = row * size_t(grid.ny);
    return {size_t(k) * slab + size_t(j) * row + size_t(i), row, slab, u, v, w};
}

template <class T>
Cell<Pack<T>> cell_of(const DistanceGrid& grid, const Vec3<Pack<T>>& x) {
    const T per_metre = T(1) / T(grid.spacing);
    const auto [i, u] = cell_place(x.x, T(grid.origin.x), per_metre, grid.nx);
    const auto [j, v] = cell_place(x.y, T(grid.origin.y), per_metre, grid.ny);
    const auto [k, w] = cell_place(x.z, T(grid.origin.z), per_metre, grid.nz);
    Cell<Pack<T>> cell{{}, size_t(grid.nx), size_t(grid.nx) * size_t(grid.ny), u, v, w};
    // A grid has at most 2^27 nodes.
    for (size_t lane = 0; lane < cell.node.of.size(); ++lane)
        cell.node.of[lane] = (k.of[lane] * grid.ny + j.of[lane]) * grid.nx + i.of[lane];
    return cell;
}

// Of the node that lies `more` beyond, in each lane.
template <class T, class Grid>
WETCURL_HD T value_at(const Grid& grid, size_t node, size_t more) {
    return grid.at(node + more);
}
template <class S, class Grid, class T>
S value_at(const Grid& grid, const Nodes<T>& nodes, size_t more) {
    S value;
    for (int lane = 0; lane < S::lanes; ++lane)
        value.v[lane] = T(grid.at(size_t(nodes.of[size_t(lane)]) + more));
    return value;
}

// Trilinear interpolant and its own gradient, x inside the grid. Grid: a DistanceGrid or one made of it.
template <class T, class Grid>
WETCURL_HD DistanceSample<T> sample_inside(const Grid& grid, const Vec3<T>& x) {
    const auto cell = cell_of(grid, x);
    const size_t row = cell.row, slab = cell.slab;
    const T u = cell.u, v = cell.v, w = cell.w;
    const auto at = [&](size_t more) { return value_at<T>(grid, cell.node, more); };
    const T p000 = at(0), p100 = at(1), p010 = at(row), p110 = at(row + 1);
    const T p001 = at(slab), p101 = at(slab + 1), p011 = at(slab + row), p111 = at(slab + row + 1);
    // Along x, then y, then z; differences are those of the corner values times spacing.
    const T q00 = p000 + u * (p100 - p000), q10 = p010 + u * (p110 - p010);
    const T q01 = p001 + u * (p101 - p001), q11 = p011 + u * (p111 - p011);
    const T r0 = q00 + v * (q10 - q00), r1 = q01 + v * (q11 - q01);
    const T x0 = (p100 - p000) + v * ((p110 - p010) - (p100 - p000));
    const T x1 = (p101 - p001) + v * ((p111 - p011) - (p101 - p001));
    const T y0 = q10 - q00, y1 = q11 - q01;
    const Vec3<T> rise{x0 + w * (x1 - x0), y0 + w * (y1 - y0), r1 - r0};
    return {r0 + w * (r1 - r0), normalized(rise, Vec3<T>{T(0), T(1), T(0)})};
}

}  // namespace detail

// phi and normal at x [m] in body coordinates, S float, double or a Pack of them. Outside the grid the
// surface point nearest to the border of the grid stands for the nearest one: an upper bound of the distance,
// right at the border and up to a quarter too far beyond (measured on a head).
template <class S, class Grid>
WETCURL_HD DistanceSample<S> sample(const Grid& grid, const Vec3<S>& x) {
    using T = Plain<S>;
    const Vec3<T> low = cast<T>(grid.origin);
    const Vec3<T> high = low + T(grid.spacing) * Vec3<T>{T(grid.nx - 1), T(grid.ny - 1), T(grid.nz - 1)};
    const Vec3<S> border = lower(upper(x, cast<S>(low)), cast<S>(high));
    const DistanceSample<S> at_border = detail::sample_inside(grid, border);
    const Vec3<S> beyond = x - border;
    const S far = dot(beyond, beyond);
    if (!any_positive(far)) return at_border;
    const Vec3<S> from_surface = beyond + at_border.phi * at_border.normal;
    const auto outside = far > S(0);
    return {select(outside, norm(from_surface), at_border.phi),
            select(outside, normalized(from_surface, at_border.normal), at_border.normal)};
}

// The spacing [m] that gives the longest side of `box` 96 cells.
double usual_spacing(const Bounds& box);
// Where the nodes of a grid lie (phi is null): `box` [m] and four cells around it, along each axis a multiple
// of `multiple` cells. `spacing` [m]; 0: the usual one. Throws Error for a box without extent or more than
// 2^27 nodes; `what` stands for the mesh in its message.
DistanceGrid laid_over(const Bounds& box, double spacing, const std::string& what, int multiple = 1);

// `$XDG_CACHE_HOME/wetcurl`, else `~/.cache/wetcurl`; "" where neither variable is set.
std::string cache_folder();

class LevelSet {
  public:
    // Builds the grid (OpenMP; the same bits for any number of threads). `spacing` [m]; 0: the longest side
    // of the mesh gets 96 cells. Throws Error for a mesh without extent or a grid of more than 2^27 nodes.
    explicit LevelSet(Mesh mesh, double spacing = 0);
    // The same through the cache: read where it is there, else built and kept. A damaged file is rebuilt with
    // a warning; a folder that cannot be written is no error. `folder` = "": no cache.
    static std::shared_ptr<const LevelSet> cached(Mesh mesh, double spacing = 0,
                                                  const std::string& folder = cache_folder());

    DistanceGrid grid() const { return {origin_, spacing_, nx_, ny_, nz_, phi_.data()}; }
    const std::vector<float>& phi() const { return phi_; }   // (nz, ny, nx) [m]
    const Mesh& mesh() const { return mesh_; }               // what it was made from
    double build_seconds() const { return build_seconds_; }  // also where it came from the cache
    bool from_cache() const { return from_cache_; }
    size_t bytes() const { return phi_.size() * sizeof(float); }

  private:
    struct Unbuilt {};
    LevelSet(Mesh mesh, double spacing, Unbuilt);
    void build();
    bool load(const std::string& path);
    void store(const std::string& path) const;
    std::string key() const;

    Mesh mesh_;
    Vec3f origin_{0, 0, 0};
    float spacing_ = 0;
    int nx_ = 0, ny_ = 0, nz_ = 0;
    std::vector<float> phi_;
    double build_seconds_ = 0;
    bool from_cache_ = false;
};

}  // namespace wetcurl
