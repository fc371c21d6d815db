// The signed distance to a mesh whose vertices move: level sets at both ends of a span of time on one grid,
// rebuilt in a narrow band. A node within the band has its exact distance; the others take the mean of the
// nodes around them on ever coarser lattices. Sign and distance as in LevelSet.
#pragma once

#include <vector>

#include "base/geometry/level_set_rebuild.h"
#include "base/pack.h"

namespace wetcurl {

// A view of both level sets at a time between them: phi is linear in time, so that a surface comes smoothly
// though it is found but once a span.
struct MovingGrid : DistanceGrid {  // phi: at the end of the span
    const float* phi_before;        // at its begin
    const Vec3f* velocity;          // [m/s] of the nearest point of the surface, mean over the span
    float share;                    // of the span that is over
    float per_second;               // 1 / span; 0: the surface rests
    // Exactly the one and the other at the ends.
    WETCURL_HD float at(size_t node) const { return (1 - share) * phi_before[node] + share * phi[node]; }
};

// Of arrays (nz, ny, nx) over the band's grid, where `share` of a span of 1 / `per_second` [s] is over.
inline MovingGrid moving_grid(const NarrowBand& band, const float* phi_before, const float* phi,
                              const Vec3f* velocity, double share, double per_second) {
    MovingGrid grid{band.grid, phi_before, velocity, float(share), float(per_second)};
    grid.phi = phi;
    return grid;
}

namespace detail {

// The trilinear interpolant of value(node), a number or a vector.
template <class T, class Value>
WETCURL_HD auto interpolated(const DistanceGrid& grid, const Vec3<T>& x, Value value) {
    const auto cell = cell_of(grid, x);
    const auto between = [](const auto& a, const auto& b, T share) { return a + share * (b - a); };
    const auto along_x = [&](size_t k) { return between(value(k), value(k + 1), cell.u); };
    const auto in_slab = [&](size_t k) { return between(along_x(k), along_x(k + cell.row), cell.v); };
    return between(in_slab(cell.node), in_slab(cell.node + cell.slab), cell.w);
}

}  // namespace detail

// Of the surface near x [m], in body coordinates [m/s]: along the normal what the level set itself does,
// -dphi/dt, so that contact and velocity never disagree; across it that of the mesh's nearest point.
template <class T>
WETCURL_HD Vec3<T> surface_velocity(const MovingGrid& grid, const Vec3<T>& x) {
    const Vec3<T> n = sample(grid, x).normal;
    const T rate = T(grid.per_second) * detail::interpolated(grid, x, [&](size_t k) {
                       return T(grid.phi[k]) - T(grid.phi_before[k]);
                   });
    const Vec3<T> u = detail::interpolated(grid, x, [&](size_t k) { return cast<T>(grid.velocity[k]); });
    return u - (rate + dot(u, n)) * n;
}
template <class T>
Vec3<Pack<T>> surface_velocity(const MovingGrid& grid, const Vec3<Pack<T>>& x) {
    Vec3<Pack<T>> out;
    for (int lane = 0; lane < Pack<T>::lanes; ++lane) {
        const Vec3<T> u = surface_velocity(grid, Vec3<T>{x.x[lane], x.y[lane], x.z[lane]});
        out.x.set(lane, u.x), out.y.set(lane, u.y), out.z.set(lane, u.z);
    }
    return out;
}

class MovingLevelSet {
  public:
    // At rest as `mesh`. `box` [m]: where distances are wanted, padded as LevelSet's. Within `band` [m] of
    // the surface they are LevelSet's. Throws Error as LevelSet does.
    MovingLevelSet(Mesh mesh, const Bounds& box, double spacing, double band);

    // The span that ended is followed by one of `seconds` that ends with `vertices` (vertex) [m], of the
    // number that the mesh has. The same bits for any number of threads.
    void advance(const std::vector<Vec3f>& vertices, double seconds);
    // At rest as `vertices` say.
    void hold(const std::vector<Vec3f>& vertices);

    // `share` of the span is over, 0 to 1. Valid until the next advance or hold.
    MovingGrid grid(double share) const;
    // What `grid` views at the span's end, (nz, ny, nx).
    const std::vector<float>& phi() const { return phi_; }
    const std::vector<Vec3f>& velocity() const { return velocity_; }
    const Mesh& mesh() const { return mesh_; }     // at the end of the span
    size_t exact_nodes() const { return exact_; }  // of the last rebuilding
    size_t nodes() const { return phi_.size(); }
    size_t bytes() const;

  private:
    void build();

    Mesh mesh_;
    MeshDistance surface_;  // its
    NarrowBand band_;
    double per_second_ = 0;                // 1 / span; 0: at rest
    std::vector<Vec3f> before_;            // vertices at the begin of the span
    std::vector<float> phi_before_, phi_;  // (nz, ny, nx) [m]
    std::vector<Vec3f> velocity_;          // (nz, ny, nx) [m/s]
    std::vector<int> triangle_;            // (nz, ny, nx) nearest one, or one near it
    size_t exact_ = 0;
};

}  // namespace wetcurl
