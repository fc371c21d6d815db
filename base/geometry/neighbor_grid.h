// Neighbours within a radius: points sorted by the cell of a regular grid (counting sort). Ours.
#pragma once

#include <cstdint>
#include <vector>

#include "base/vec3.h"

namespace wetcurl {

// Points as three arrays, a vector longer than they count: one may be read from any point on.
struct PointArrays {
    std::vector<float> x, y, z;
    void resize(size_t count) {
        const size_t n = count + size_t(lanes_of<float>);
        x.resize(n), y.resize(n), z.resize(n);
    }
    Vec3f at(size_t k) const { return {x[k], y[k], z[k]}; }
    void set(size_t k, const Vec3f& p) { x[k] = p.x, y[k] = p.y, z[k] = p.z; }
    Vec3<Pack<float>> load(size_t k) const {
        return {Pack<float>::load(&x[k]), Pack<float>::load(&y[k]), Pack<float>::load(&z[k])};
    }
    size_t bytes() const { return (x.capacity() + y.capacity() + z.capacity()) * sizeof(float); }
};

// Points in the order of their cells; `order[k]` is the index of sorted point k in the input.
// Buffers keep their memory from one build to the next.
class NeighborGrid {
  public:
    // `positions` (count) [m]; three cells along x, one along y and z, are `radius` [m] at least.
    void build(const Vec3f* positions, size_t count, float radius);
    size_t size() const { return order_.size(); }
    const std::vector<uint32_t>& order() const { return order_; }
    Vec3f sorted(size_t k) const { return points_.at(k); }
    // The sorted points. Who has searched may move them.
    PointArrays& points() { return points_; }
    const PointArrays& points() const { return points_; }
    size_t bytes() const;

    // Calls visit(begin, end) for each row of cells around x: at most nine ranges of sorted points that hold
    // all within the radius (the caller tests the distance). x may lie anywhere.
    template <class Visit>
    void rows(const Vec3f& x, Visit visit) const {
        const int cx = column(x.x), cy = cell(x.y, origin_.y), cz = cell(x.z, origin_.z);
        const int x0 = cx > split ? cx - split : 0, x1 = cx + split < nx_ ? cx + split : nx_ - 1;
        if (x0 > x1) return;
        for (int z = cz > 0 ? cz - 1 : 0; z <= cz + 1 && z < nz_; ++z)
            for (int y = cy > 0 ? cy - 1 : 0; y <= cy + 1 && y < ny_; ++y) {
                const size_t row = (size_t(z) * size_t(ny_) + size_t(y)) * size_t(nx_);
                visit(start_[row + size_t(x0)], start_[row + size_t(x1) + 1]);
            }
    }
    // Calls visit(k) for each sorted point k of those rows.
    template <class Visit>
    void around(const Vec3f& x, Visit visit) const {
        rows(x, [&](uint32_t begin, uint32_t end) {
            for (uint32_t k = begin; k < end; ++k) visit(k);
        });
    }

  private:
    // Cells are `split` times shorter along a row: its points then lie nearly in the order of x.
    static constexpr int split = 3;
    static int clamped(float cell) {
        return cell < -2 * split ? -2 * split : cell > 1e6f ? 1000000 : int(cell);
    }
    int cell(float x, float origin) const { return clamped(std::floor((x - origin) * inverse_)); }
    int column(float x) const { return clamped(std::floor((x - origin_.x) * (split * inverse_))); }
    size_t cell_of(const Vec3f& p) const {
        return (size_t(cell(p.z, origin_.z)) * size_t(ny_) + size_t(cell(p.y, origin_.y))) * size_t(nx_) +
               size_t(column(p.x));
    }
    Vec3f origin_{0, 0, 0};
    float inverse_ = 1;
    int nx_ = 0, ny_ = 0, nz_ = 0;
    std::vector<uint32_t> start_, order_;
    PointArrays points_;
};

}  // namespace wetcurl
