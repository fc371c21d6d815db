// Stencils on the roots.
#include "learn/codec/stencil.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "base/error.h"
#include "learn/codec/root_grid.h"

namespace wetcurl {

void require_nested(const Groom& high, const Groom& low) {
    const Groom wanted = coarsened(high, 2);
    auto size = [](const Groom& g) {
        return std::to_string(g.grid.width) + " x " + std::to_string(g.grid.height) + " roots, " +
               std::to_string(g.rest.count) + " strands of " + std::to_string(g.rest.particles) +
               " particles";
    };
    if (wanted.grid.strand != low.grid.strand || wanted.rest.particles != low.rest.particles)
        throw Error("grooms do not nest: the low-resolution one has " + size(low) +
                    ", allowed is every second root each way of the high-resolution one: " + size(wanted));
    for (int s = 0; s < low.rest.count; ++s)
        for (int i = 0; i < low.rest.particles; ++i) {
            const float apart = norm(low.rest.at(s, i) - wanted.rest.at(s, i));
            if (!(apart < 1e-5f))
                throw Error("grooms do not nest: strand " + std::to_string(s) + ", particle " +
                            std::to_string(i) + " lies " + std::to_string(apart * 1e3f) +
                            " mm from its high-resolution twin, allowed 0.01 mm");
        }
}

// The `k` low strands with the nearest roots, nearest first; k ≤ number of low strands.
static std::vector<int> nearest_roots(const Vec3f& root, const Groom& low, int k) {
    std::vector<std::pair<float, int>> best;  // kept sorted, no longer than k
    for (int s = 0; s < low.rest.count; ++s) {
        const Vec3f d = low.rest.at(s, 0) - root;
        const std::pair<float, int> entry{dot(d, d), s};
        if (int(best.size()) == k && !(entry < best.back())) continue;
        best.insert(std::upper_bound(best.begin(), best.end(), entry), entry);
        if (int(best.size()) > k) best.pop_back();
    }
    std::vector<int> out;
    for (const auto& entry : best) out.push_back(entry.second);
    return out;
}

// The stencil less its weights, which `fill(high strand, from, weight)` gives (both start at the nearest root
// and 0).
template <class Fill>
static Stencil stencil_of(const Groom& high, const Groom& low, int width, Fill fill) {
    require_nested(high, low);
    if (low.rest.count == 0)
        throw Error("interpolation: the low-resolution groom has no strand, allowed 1 or more");
    Stencil out;
    out.width = width;
    coarsened(high, 2, &out.twin);
    const size_t n = size_t(high.rest.count);
    out.from.resize(n * width);
    out.weight.assign(n * width, 0);
    out.nearest.resize(n);
#pragma omp parallel for schedule(dynamic, 16)
    for (size_t s = 0; s < n; ++s) {
        out.nearest[s] = nearest_roots(high.rest.at(int(s), 0), low, 1)[0];
        int* from = out.from.data() + s * width;
        float* weight = out.weight.data() + s * width;
        std::fill_n(from, width, out.nearest[s]);
        fill(int(s), from, weight);
        float sum = 0;
        for (int k = 0; k < width; ++k) sum += weight[k];
        if (sum > 0)
            for (int k = 0; k < width; ++k) weight[k] /= sum;
        else
            weight[0] = 1;  // of the nearest root
    }
    return out;
}

Stencil quad_stencil(const Groom& high, const Groom& low) {
    const auto pixel = pixels_of_strands(high.grid, high.rest.count);
    return stencil_of(high, low, 4, [&](int s, int* from, float* weight) {
        const int column = pixel[size_t(s)] % high.grid.width, row = pixel[size_t(s)] / high.grid.width;
        for (int k = 0; k < 4; ++k) {
            // An even pixel meets its own twin in all four corners: one is enough.
            const int right = k % 2, down = k / 2;
            if ((right && column % 2 == 0) || (down && row % 2 == 0)) continue;
            const int c = column / 2 + right, r = row / 2 + down;
            if (c >= low.grid.width || r >= low.grid.height || low.grid.at(c, r) < 0) continue;
            from[k] = low.grid.at(c, r);
            weight[k] = 1;
        }
    });
}

// Barycentric coordinates of x in the triangle a, b, c, all in the plane across n; negative ones cut off.
static std::array<float, 3> barycentric(const Vec3d& x, const Vec3d& a, const Vec3d& b, const Vec3d& c,
                                        const Vec3d& n) {
    auto area = [&](const Vec3d& p, const Vec3d& q, const Vec3d& r) { return dot(cross(q - p, r - p), n); };
    const double whole = area(a, b, c);
    const double longest = std::max({dot(b - a, b - a), dot(c - b, c - b), dot(a - c, a - c)});
    if (std::abs(whole) < 1e-3 * longest) {
        // Nearly on a line: the two nearest, by where x falls between them.
        const double t = std::clamp(dot(x - a, b - a) / std::max(dot(b - a, b - a), 1e-30), 0.0, 1.0);
        return {float(1 - t), float(t), 0};
    }
    auto share = [&](double part) { return float(std::max(0.0, part / whole)); };
    return {share(area(x, b, c)), share(area(a, x, c)), share(area(a, b, x))};
}

Stencil triangle_stencil(const Groom& high, const Groom& low) {
    return stencil_of(high, low, 3, [&](int s, int* from, float* weight) {
        const Vec3f root = high.rest.at(s, 0);
        const auto near = nearest_roots(root, low, std::min(3, low.rest.count));
        std::copy(near.begin(), near.end(), from);
        if (near.size() < 3) return;
        auto at = [&](int k) { return cast<double>(low.rest.at(near[size_t(k)], 0)); };
        const auto w =
            barycentric(cast<double>(root), at(0), at(1), at(2), cast<double>(high.normal[size_t(s)]));
        std::copy(w.begin(), w.end(), weight);
    });
}

}  // namespace wetcurl
