// Stencils on the roots.
#include "learn/codec/stencil.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>

#include "base/error.h"
#include "learn/codec/root_grid.h"

namespace wetcurl {

// How far apart strands are at most that are the same [m].
constexpr float same_within = 1e-5f;

static std::string size_of(const Groom& g) {
    return std::to_string(g.grid.width) + " x " + std::to_string(g.grid.height) + " roots, " +
           std::to_string(g.rest.count) + " strands of " + std::to_string(g.rest.particles) + " particles";
}

// The first particle by which two strands differ, -1: none.
static int difference(const Vec3f* a, const Vec3f* b, int n) {
    for (int i = 0; i < n; ++i)
        if (!(norm(a[i] - b[i]) < same_within)) return i;
    return -1;
}

void require_nested(const Groom& high, const Groom& low) {
    const Groom wanted = coarsened(high, 2);
    if (wanted.grid.strand != low.grid.strand || wanted.rest.particles != low.rest.particles)
        throw Error("grooms do not nest: the low-resolution one has " + size_of(low) +
                    ", allowed is every second root each way of the high-resolution one: " + size_of(wanted));
    for (int s = 0; s < low.rest.count; ++s)
        if (const int i = difference(low.rest.strand(s), wanted.rest.strand(s), low.rest.particles); i >= 0)
            throw Error("grooms do not nest: strand " + std::to_string(s) + ", particle " +
                        std::to_string(i) + " lies " +
                        std::to_string(norm(low.rest.at(s, i) - wanted.rest.at(s, i)) * 1e3f) +
                        " mm from its high-resolution twin, allowed 0.01 mm");
}

// Every how many roots each way of `high` there is one of `low`, 0: it is no such grid.
static int stride_of(const Groom& high, const Groom& low) {
    if (low.rest.particles != high.rest.particles) return 0;
    const int most = std::max(high.grid.width, high.grid.height);
    for (int stride = 1; stride <= most; ++stride) {
        if ((high.grid.width + stride - 1) / stride != low.grid.width ||
            (high.grid.height + stride - 1) / stride != low.grid.height)
            continue;
        const Groom wanted = coarsened(high, stride);
        if (wanted.grid.strand != low.grid.strand) continue;
        bool same = true;
        for (int s = 0; same && s < low.rest.count; ++s)
            same = difference(low.rest.strand(s), wanted.rest.strand(s), low.rest.particles) < 0;
        if (same) return stride;
    }
    return 0;
}

bool nests(const Groom& high, const Groom& low) { return stride_of(high, low) > 0; }

// The `k` strands of a groom with the nearest roots, nearest first; k ≤ number of strands. Squares of
// distances [m^2] with them.
static std::vector<std::pair<float, int>> nearest_roots(const Vec3f& root, const Groom& groom, int k) {
    std::vector<std::pair<float, int>> best;  // kept sorted, no longer than k
    for (int s = 0; s < groom.rest.count; ++s) {
        const Vec3f d = groom.rest.at(s, 0) - root;
        const std::pair<float, int> entry{dot(d, d), s};
        if (int(best.size()) == k && !(entry < best.back())) continue;
        best.insert(std::upper_bound(best.begin(), best.end(), entry), entry);
        if (int(best.size()) > k) best.pop_back();
    }
    return best;
}

std::vector<int> twins_of(const Groom& high, const Groom& low) {
    const int n = low.rest.particles;
    std::vector<std::pair<float, int>> by_x;  // roots
    for (int s = 0; s < high.rest.count; ++s) by_x.emplace_back(high.rest.at(s, 0).x, s);
    std::sort(by_x.begin(), by_x.end());
    std::vector<int> out(size_t(low.rest.count), -1);
    for (int s = 0; s < low.rest.count; ++s) {
        const float x = low.rest.at(s, 0).x;
        auto at = std::lower_bound(by_x.begin(), by_x.end(), std::pair{x - same_within, -1});
        for (; at != by_x.end() && at->first <= x + same_within; ++at)
            if (difference(low.rest.strand(s), high.rest.strand(at->second), n) < 0) {
                out[size_t(s)] = at->second;
                break;
            }
    }
    return out;
}

void require_part(const Groom& high, const Groom& low) {
    if (low.rest.particles != high.rest.particles)
        throw Error("found low-resolution strands of " + std::to_string(low.rest.particles) +
                    " particles, allowed as many as the others have: " + std::to_string(high.rest.particles));
    const std::vector<int> twin = twins_of(high, low);
    for (int s = 0; s < low.rest.count; ++s) {
        if (twin[size_t(s)] >= 0) continue;
        const int near = nearest_roots(low.rest.at(s, 0), high, 1)[0].second,
                  i = difference(low.rest.strand(s), high.rest.strand(near), low.rest.particles);
        throw Error("low-resolution strand " + std::to_string(s) +
                    " is none of those to predict: found particle " + std::to_string(i) + " " +
                    std::to_string(norm(low.rest.at(s, i) - high.rest.at(near, i)) * 1e3f) +
                    " mm from that of the strand with the nearest root, allowed 0.01 mm");
    }
}

// The stencil less its weights, which `fill(high strand, from, weight)` gives (both start at the nearest root
// and 0), and less what is beside low strands.
template <class Fill>
static Stencil stencil_of(const Groom& high, const Groom& low, int width, Fill fill) {
    if (low.rest.count == 0)
        throw Error("interpolation: the low-resolution groom has no strand, allowed 1 or more");
    if (low.rest.particles != high.rest.particles)
        throw Error("interpolation: found low-resolution strands of " + std::to_string(low.rest.particles) +
                    " particles, allowed as many as the others have: " + std::to_string(high.rest.particles));
    Stencil out;
    out.width = width;
    out.twin = twins_of(high, low);
    const size_t n = size_t(high.rest.count);
    out.from.resize(n * width);
    out.weight.assign(n * width, 0);
    out.nearest.resize(n);
#pragma omp parallel for schedule(dynamic, 16)
    for (size_t s = 0; s < n; ++s) {
        out.nearest[s] = nearest_roots(high.rest.at(int(s), 0), low, 1)[0].second;
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

// On the grid.
static std::vector<Beside> beside_on_grid(const Groom& low) {
    std::vector<Beside> out(size_t(low.rest.count));
    for (int row = 0; row < low.grid.height; ++row)
        for (int column = 0; column < low.grid.width; ++column) {
            const int s = low.grid.at(column, row);
            if (s < 0) continue;
            int count = 0;
            for (auto [c, r] :
                 {std::pair{column - 1, row}, {column + 1, row}, {column, row - 1}, {column, row + 1}})
                if (c >= 0 && r >= 0 && c < low.grid.width && r < low.grid.height && low.grid.at(c, r) >= 0)
                    out[size_t(s)].strand[count++] = low.grid.at(c, r);
        }
    return out;
}

// By roots.
static std::vector<Beside> nearest_beside(const Groom& low) {
    std::vector<Beside> out(size_t(low.rest.count));
#pragma omp parallel for schedule(dynamic, 16)
    for (int s = 0; s < low.rest.count; ++s) {
        int count = 0;
        for (const auto& [square, other] :
             nearest_roots(low.rest.at(s, 0), low, std::min(low.rest.count, Stencil::widest + 1)))
            if (other != s && count < Stencil::widest) out[size_t(s)].strand[count++] = other;
    }
    return out;
}

Stencil quad_stencil(const Groom& high, const Groom& low) {
    const int stride = stride_of(high, low);
    if (stride == 0)
        throw Error("grooms do not nest: the low-resolution one has " + size_of(low) +
                    ", allowed is every second, third… root each way of the high-resolution one, which has " +
                    size_of(high));
    const auto pixel = pixels_of_strands(high.grid, high.rest.count);
    Stencil out = stencil_of(high, low, 4, [&](int s, int* from, float* weight) {
        const int column = pixel[size_t(s)] % high.grid.width, row = pixel[size_t(s)] / high.grid.width;
        const float u = float(column % stride) / float(stride), v = float(row % stride) / float(stride);
        for (int k = 0; k < 4; ++k) {
            const int right = k % 2, down = k / 2, c = column / stride + right, r = row / stride + down;
            const float share = (right ? u : 1 - u) * (down ? v : 1 - v);
            if (share == 0 || c >= low.grid.width || r >= low.grid.height || low.grid.at(c, r) < 0) continue;
            from[k] = low.grid.at(c, r);
            weight[k] = share;
        }
    });
    out.beside = beside_on_grid(low);
    return out;
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

// Of the nearest roots the three around x: the smallest triangle of them that holds it, or, where none does,
// the nearest three. Places in `near`.
static std::array<int, 3> around_root(const Vec3d& x, const std::vector<Vec3d>& near, const Vec3d& n) {
    std::array<int, 3> best{0, 1, 2};
    double smallest = std::numeric_limits<double>::infinity();
    const auto square = [](const Vec3d& d) { return dot(d, d); };
    for (int a = 0; a < int(near.size()); ++a)
        for (int b = a + 1; b < int(near.size()); ++b)
            for (int c = b + 1; c < int(near.size()); ++c) {
                const Vec3d &A = near[size_t(a)], &B = near[size_t(b)], &C = near[size_t(c)];
                const double size = square(B - A) + square(C - B) + square(A - C);
                if (size >= smallest) continue;
                const auto side = [&](const Vec3d& p, const Vec3d& q) { return dot(cross(p - x, q - x), n); };
                const double ab = side(A, B), bc = side(B, C), ca = side(C, A),
                             least = -1e-3 * std::abs(ab + bc + ca);
                const bool holds = (std::min({ab, bc, ca}) >= least || std::max({ab, bc, ca}) <= -least) &&
                                   std::abs(ab + bc + ca) > 1e-3 * size;
                if (holds) best = {a, b, c}, smallest = size;
            }
    return best;
}

Stencil triangle_stencil(const Groom& high, const Groom& low) {
    constexpr int looked_at = 8;
    Stencil out = stencil_of(high, low, 3, [&](int s, int* from, float* weight) {
        const Vec3d root = cast<double>(high.rest.at(s, 0)), normal = cast<double>(high.normal[size_t(s)]);
        const auto near = nearest_roots(high.rest.at(s, 0), low, std::min(looked_at, low.rest.count));
        if (near.size() < 3) {
            for (size_t k = 0; k < near.size(); ++k) from[k] = near[k].second;
            return;
        }
        std::vector<Vec3d> roots;
        for (const auto& [square, strand] : near) roots.push_back(cast<double>(low.rest.at(strand, 0)));
        const auto chosen = around_root(root, roots, normal);
        const auto w = barycentric(root, roots[size_t(chosen[0])], roots[size_t(chosen[1])],
                                   roots[size_t(chosen[2])], normal);
        for (size_t k = 0; k < 3; ++k) from[k] = near[size_t(chosen[k])].second, weight[k] = w[k];
    });
    out.beside = nests(high, low) ? beside_on_grid(low) : nearest_beside(low);
    return out;
}

Stencil surrounding_stencil(const Groom& high, const Groom& low) {
    return nests(high, low) ? quad_stencil(high, low) : triangle_stencil(high, low);
}

}  // namespace wetcurl
