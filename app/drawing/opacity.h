// How much hair lies between a point and a light: a box of cells whose third axis points to the light, filled
// with the area that hair shows and summed along that axis. After Yuksel and Keyser 2008 (deep opacity), on
// cells.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/vec3.h"

namespace wetcurl {

class Opacity {
  public:
    // Cells of size `cell` [m] around all of `points`; `light` is the unit direction to the light.
    Opacity(const std::vector<Vec3f>& points, const Vec3f& light, float cell) : cell_(cell), c_(light) {
        a_ = normalized(any_perpendicular(light), Vec3f{1, 0, 0});
        b_ = cross(c_, a_);
        Vec3f low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};
        for (const Vec3f& x : points) {
            Vec3f l = to_light_frame(x);
            low = {std::min(low.x, l.x), std::min(low.y, l.y), std::min(low.z, l.z)};
            high = {std::max(high.x, l.x), std::max(high.y, l.y), std::max(high.z, l.z)};
        }
        origin_ = low - Vec3f{2 * cell, 2 * cell, 2 * cell};
        auto cells = [&](float from, float to) { return int(std::ceil((to - from) / cell)) + 5; };
        na_ = cells(low.x, high.x), nb_ = cells(low.y, high.y), nc_ = cells(low.z, high.z);
        depth_.assign(size_t(na_) * nb_ * nc_, 0.f);
    }

    // Adds `area` [m^2] that blocks the light at x, shared among the eight nearest cell centres.
    void deposit(const Vec3f& x, float area) {
        Place p = place(x);
        if (!p.inside || p.k < 0 || p.k + 1 >= nc_) return;
        for (int d = 0; d < 8; ++d) depth_[index(p, d)] += area / (cell_ * cell_) * weight(p, d);
    }

    // After the last deposit: areas become optical depths, summed from the light downwards; a cell counts
    // half of what is its own. `wide`: the light is no ray but a cone, and a shadow spreads on its way.
    void accumulate(bool wide = false) {
        const size_t layer = size_t(na_) * nb_;
        std::vector<float> above(layer, 0.f);
        for (int k = nc_ - 1; k >= 0; --k) {
            for (size_t i = 0; i < layer; ++i) {
                float own = depth_[k * layer + i];
                depth_[k * layer + i] = above[i] + 0.5f * own;
                above[i] += own;
            }
            if (wide) blur(above.data());
        }
    }
    // After that: surfaces, which let nothing through, have a soft edge some cells wide in place of the
    // cells'.
    void soften() {
        is_share_ = true;
        for (float& depth : depth_) depth = std::exp(-depth);
        for (int k = 0; k < nc_; ++k)
            for (int pass = 0; pass < 3; ++pass) blur(depth_.data() + size_t(k) * na_ * nb_);
    }

    // Share of the light that reaches x.
    float transmittance(const Vec3f& x) const {
        Place p = place(x);
        if (!p.inside || p.k + 1 >= nc_) return 1;
        if (p.k < 0) p.k = 0, p.w = 0;
        float sum = 0;
        for (int d = 0; d < 8; ++d) sum += depth_[index(p, d)] * weight(p, d);
        return is_share_ ? sum : std::exp(-sum);
    }

    float cell() const { return cell_; }

  private:
    struct Place {
        int i, j, k;
        float u, v, w;
        bool inside;  // of the columns of cells
    };
    Vec3f to_light_frame(const Vec3f& x) const { return {dot(a_, x), dot(b_, x), dot(c_, x)}; }
    Place place(const Vec3f& x) const {
        Vec3f l = (1 / cell_) * (to_light_frame(x) - origin_) - Vec3f{0.5f, 0.5f, 0.5f};
        float i = std::floor(l.x), j = std::floor(l.y), k = std::clamp(std::floor(l.z), -1.f, float(nc_));
        bool inside = i >= 0 && j >= 0 && i + 1 < na_ && j + 1 < nb_;
        return {inside ? int(i) : 0,
                inside ? int(j) : 0,
                int(k),
                l.x - i,
                l.y - j,
                std::clamp(l.z - k, 0.f, 1.f),
                inside};
    }
    size_t index(const Place& p, int d) const {
        return (size_t(p.k + (d >> 2)) * nb_ + p.j + (d >> 1 & 1)) * na_ + p.i + (d & 1);
    }
    static float weight(const Place& p, int d) {
        return (d & 1 ? p.u : 1 - p.u) * (d & 2 ? p.v : 1 - p.v) * (d & 4 ? p.w : 1 - p.w);
    }

    // A layer of cells: each becomes the mean of itself and its neighbours, along its row and along its
    // column.
    void blur(float* layer) {
        const size_t n = size_t(na_);
        std::vector<float> line(n + 2), above(n);
        for (int j = 0; j < nb_; ++j) {
            float* row = layer + j * n;
            std::copy(row, row + n, line.begin() + 1);
            line.front() = row[0], line.back() = row[n - 1];
            for (size_t i = 0; i < n; ++i) row[i] = (line[i] + line[i + 1] + line[i + 2]) / 3;
        }
        std::copy(layer, layer + n, above.begin());
        for (int j = 0; j < nb_; ++j) {
            float *row = layer + j * n, *below = j + 1 < nb_ ? row + n : row;
            for (size_t i = 0; i < n; ++i) {
                const float own = row[i];
                row[i] = (above[i] + own + below[i]) / 3;
                above[i] = own;
            }
        }
    }

    float cell_;
    Vec3f a_, b_, c_, origin_;
    int na_, nb_, nc_;
    std::vector<float> depth_;  // optical; where `is_share_`, the share of the light
    bool is_share_ = false;
};

}  // namespace wetcurl
