// Stencils on the roots, and what they carry to the new roots.
// Ours.
#include "learn/interpolate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "learn/core_detail.h"
#include "learn/root_grid.h"

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

Interpolation interpolation_named(const std::string& name) {
    static const std::vector<std::string> names{"nearest", "quad", "core", "rest"};
    for (size_t k = 0; k < names.size(); ++k)
        if (names[k] == name) return Interpolation(k);
    throw Misuse("interpolation: found '" + name + "', allowed nearest, quad, core, rest" +
                 did_you_mean(name, names));
}

static void take_cores(const Strands& strands, Strands& cores) {
    const float beta = core_beta(strands.particles);
#pragma omp parallel for schedule(static)
    for (int s = 0; s < strands.count; ++s)
        core_of(strands.strand(s), strands.particles, beta, cores.strand(s));
}
static Strands cores_of(const Strands& strands) {
    Strands cores(strands.count, strands.particles);
    take_cores(strands, cores);
    return cores;
}

Interpolator::Interpolator(Interpolation kind, Stencil stencil, const Groom& high, const Groom& low,
                           const Strands* shape)
    : kind_(kind), stencil_(std::move(stencil)), roots_(root_frames(high)) {
    if (kind_ == Interpolation::core || kind_ == Interpolation::rest)
        cores_ = Strands(low.rest.count, low.rest.particles);
    if (kind_ != Interpolation::rest) return;
    rest_ = shape ? *shape : high.rest;  // its detail
    auto size = [](const Strands& s) {
        return std::to_string(s.count) + " strands of " + std::to_string(s.particles) + " particles";
    };
    if (size(rest_) != size(high.rest))
        throw Error("interpolation: found a shape at rest of " + size(rest_) + ", allowed that of all " +
                    size(high.rest));
    rest_cores_ = cores_of(high.rest), low_rest_cores_ = cores_of(low.rest);
    detail_cores_ = cores_of(rest_);
}

// root + sum_k weight_k (strand_k - its root), for `n` particles.
static void weighted_mean(const Strands& strands, const int* from, const float* weight, int width,
                          const Vec3f& root, Vec3f* out) {
    std::fill_n(out, strands.particles, root);
    for (int k = 0; k < width; ++k) {
        if (weight[k] == 0) continue;
        const Vec3f* p = strands.strand(from[k]);
        for (int i = 1; i < strands.particles; ++i) out[i] += weight[k] * (p[i] - p[0]);
    }
}

// Adds to the core `out` the detail of strand p around its own core. The turn that takes one core's edge to
// the other's is carried on from edge to edge, so that it does not flip where the two point opposite ways.
static void add_detail(const Vec3f* p, const Vec3f* core, int n, Vec3f* out) {
    Quatf turn = Quatf::identity();
    // In this order edge i of `out` is still bare core when particle i asks for it; the tip takes the last
    // one's.
    for (int i = 0; i < n; ++i) {
        if (i + 1 < n) {
            const Vec3f from = rotate(turn, core[i + 1] - core[i]), to = out[i + 1] - out[i];
            if (norm(from) > tiny_length<float> && norm(to) > tiny_length<float>)
                turn = normalized(minimal_rotation(normalized(from, to), normalized(to, from)) * turn);
        }
        out[i] += rotate(turn, p[i] - core[i]);
    }
}

// To the ways `out` of a core (n): that core at rest, its edges as much shorter as the curled core's are, and
// the detail of the curled strand p. All but `out` in the head's frame.
static void add_rest(const Vec3f* core, const Vec3f* p, const Vec3f* curled_core, int n, const Quatf& head,
                     std::vector<Vec3f>& turned, Vec3f* out) {
    turned.resize(2 * size_t(n));
    for (int i = 0; i < n; ++i) {
        turned[size_t(i)] = rotate(head, p[i]), turned[size_t(n + i)] = rotate(head, curled_core[i]);
        out[i] += rotate(head, core[i] - core[0]);
    }
    Vec3f before = out[0];
    for (int i = 1; i < n; ++i) {
        const float drawn = norm(core[i] - core[i - 1]), curled = norm(curled_core[i] - curled_core[i - 1]);
        const Vec3f edge = out[i] - before;
        before = out[i];
        out[i] = out[i - 1] + (curled / std::max(drawn, tiny_length<float>)) * edge;
    }
    add_detail(turned.data(), turned.data() + n, n, out);
}

void Interpolator::apply(const Strands& low, const Pose& head, Strands& out) {
    const int n = low.particles, width = stencil_.width;
    if (low.count != int(stencil_.twin.size()))
        throw Error("interpolation: found " + std::to_string(low.count) +
                    " low-resolution strands, allowed " + std::to_string(stencil_.twin.size()));
    if (out.count != stencil_.count() || out.particles != n) out = Strands(stencil_.count(), n);
    if (cores_.count) take_cores(low, cores_);
    if (kind_ == Interpolation::rest) {
        // What is left of the cores is how they have moved.
        const Quatf turn = cast<float>(head.rotation);
#pragma omp parallel for schedule(static)
        for (int s = 0; s < low.count; ++s)
            for (int i = n - 1; i >= 0; --i)
                cores_.at(s, i) = cores_.at(s, i) - cores_.at(s, 0) -
                                  rotate(turn, low_rest_cores_.at(s, i) - low_rest_cores_.at(s, 0));
    }
#pragma omp parallel
    {
        std::vector<Vec3f> turned;
#pragma omp for schedule(static)
        for (int s = 0; s < out.count; ++s) {
            const int nearest = stencil_.nearest[size_t(s)];
            const int* from = stencil_.from.data() + size_t(s) * width;
            const float* weight = stencil_.weight.data() + size_t(s) * width;
            const Vec3f root = roots_.root_at(s, head);
            const float one = 1;
            switch (kind_) {
                case Interpolation::nearest:
                    weighted_mean(low, &nearest, &one, 1, root, out.strand(s));
                    break;
                case Interpolation::quad:
                    weighted_mean(low, from, weight, width, root, out.strand(s));
                    break;
                case Interpolation::core:
                    weighted_mean(cores_, from, weight, width, root, out.strand(s));
                    add_detail(low.strand(nearest), cores_.strand(nearest), n, out.strand(s));
                    break;
                case Interpolation::rest: {
                    weighted_mean(cores_, from, weight, width, root, out.strand(s));
                    add_rest(rest_cores_.strand(s), rest_.strand(s), detail_cores_.strand(s), n,
                             cast<float>(head.rotation), turned, out.strand(s));
                    break;
                }
            }
        }
    }
}

}  // namespace wetcurl
