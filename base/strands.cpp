// Strands and root grids.
#include "base/strands.h"

#include <algorithm>
#include <cstdio>

#include "base/error.h"

namespace wetcurl {

std::string hash_bytes(const void* data, size_t bytes, unsigned long long seed) {
    unsigned long long h = seed;
    auto* p = static_cast<const unsigned char*>(data);
    for (size_t i = 0; i < bytes; ++i) h = (h ^ p[i]) * 1099511628211ull;
    char text[17];
    std::snprintf(text, sizeof text, "%016llx", h);
    return text;
}

std::string hash_of_file(const std::string& path) {
    std::FILE* file = std::fopen(path.c_str(), "rb");
    if (!file) throw Error(path + ": cannot be read");
    std::vector<char> block(size_t(1) << 20);
    std::string hash = hash_bytes(nullptr, 0);
    while (const size_t n = std::fread(block.data(), 1, block.size(), file))
        hash =
            hash_bytes(block.data(), n, std::stoull(hash, nullptr, 16));  // the state so far is the next seed
    std::fclose(file);
    return hash;
}

std::string Groom::hash() const {
    std::string a = hash_bytes(rest.points.data(), rest.points.size() * sizeof(Vec3f));
    std::string b = hash_bytes(grid.strand.data(), grid.strand.size() * sizeof(int));
    return hash_bytes((a + b).data(), a.size() + b.size());
}

std::vector<StrandOrigin> origins_of(const Groom& groom) {
    if (!groom.origin.empty()) return groom.origin;
    std::vector<StrandOrigin> origin(size_t(groom.rest.count));
    for (int row = 0; row < groom.grid.height; ++row)
        for (int column = 0; column < groom.grid.width; ++column)
            if (const int s = groom.grid.at(column, row); s >= 0 && s < groom.rest.count)
                origin[size_t(s)] = {
                    .number = s,
                    .id = s,
                    .uv = {float(column) / float(groom.grid.width), float(row) / float(groom.grid.height)}};
    return origin;
}

// Strands `from` of `full` on that grid.
static Groom taken(const Groom& full, const std::vector<int>& from, RootGrid grid) {
    Groom out;
    out.grid = std::move(grid);
    out.rest = Strands(int(from.size()), full.rest.particles);
    out.normal.resize(from.size());
    out.origin.resize(from.size());
    const std::vector<StrandOrigin> origin = origins_of(full);
    for (size_t s = 0; s < from.size(); ++s) {
        std::copy_n(full.rest.strand(from[s]), full.rest.particles, out.rest.strand(int(s)));
        out.normal[s] = full.normal[size_t(from[s])];
        out.origin[s] = origin[size_t(from[s])];
        if (full.width.empty()) continue;
        const auto width = full.width.begin() + long(from[s]) * full.rest.particles;
        out.width.insert(out.width.end(), width, width + full.rest.particles);
    }
    return out;
}

Groom coarsened(const Groom& full, int stride, std::vector<int>* kept) {
    if (stride < 1)
        throw Error("stride of a coarser grid: found " + std::to_string(stride) + ", allowed 1 or more");
    RootGrid grid;
    grid.width = (full.grid.width + stride - 1) / stride;
    grid.height = (full.grid.height + stride - 1) / stride;
    grid.strand.assign(size_t(grid.width) * grid.height, -1);
    std::vector<int> from;
    for (int row = 0; row < grid.height; ++row)
        for (int column = 0; column < grid.width; ++column)
            if (int s = full.grid.at(column * stride, row * stride); s >= 0) {
                grid.strand[size_t(row) * grid.width + column] = int(from.size());
                from.push_back(s);
            }
    if (kept) *kept = from;
    return taken(full, from, std::move(grid));
}

Groom part_of(const Groom& full, const std::vector<int>& kept) {
    RootGrid row{int(kept.size()), 1, {}};
    for (int s = 0; s < row.width; ++s) row.strand.push_back(s);
    return taken(full, kept, std::move(row));
}

template <class T>
static double polyline_length(const Vec3<T>* p, int n) {
    double sum = 0;
    for (int i = 0; i + 1 < n; ++i) sum += norm(cast<double>(p[i + 1] - p[i]));
    return sum;
}
double arc_length(const Vec3f* points, int n) { return polyline_length(points, n); }
double arc_length(const Vec3d* points, int n) { return polyline_length(points, n); }

std::vector<Vec3d> resampled(const std::vector<Vec3d>& given, int n) {
    // Repeated points carry no shape and would divide by zero.
    std::vector<Vec3d> p;
    for (const auto& x : given)
        if (p.empty() || norm(x - p.back()) > 1e-9) p.push_back(x);
    if (p.size() < 2) throw Error("resampling needs a strand of two distinct points or more");
    if (n < 2) throw Error("resampling: found " + std::to_string(n) + " particles, allowed 2 or more");
    const int m = int(p.size());
    // Centripetal Catmull-Rom (Barry and Goldman 1988), ends mirrored, walked in fine steps for its arc
    // length.
    constexpr int fine = 16;
    std::vector<Vec3d> curve{p[0]};
    for (int k = 0; k + 1 < m; ++k) {
        const Vec3d p1 = p[k], p2 = p[k + 1];
        const Vec3d p0 = k > 0 ? p[k - 1] : 2.0 * p1 - p2, p3 = k + 2 < m ? p[k + 2] : 2.0 * p2 - p1;
        const double t1 = std::sqrt(norm(p1 - p0)), t2 = t1 + std::sqrt(norm(p2 - p1)),
                     t3 = t2 + std::sqrt(norm(p3 - p2));
        for (int j = 1; j <= fine; ++j) {
            const double t = t1 + (t2 - t1) * j / fine;
            auto mix = [t](const Vec3d& a, const Vec3d& b, double ta, double tb) {
                return ((tb - t) / (tb - ta)) * a + ((t - ta) / (tb - ta)) * b;
            };
            const Vec3d a1 = mix(p0, p1, 0, t1), a2 = mix(p1, p2, t1, t2), a3 = mix(p2, p3, t2, t3);
            curve.push_back(mix(mix(a1, a2, 0, t2), mix(a2, a3, t1, t3), t1, t2));
        }
    }
    std::vector<double> at(curve.size(), 0);
    for (size_t i = 1; i < curve.size(); ++i) at[i] = at[i - 1] + norm(curve[i] - curve[i - 1]);
    std::vector<Vec3d> out(static_cast<size_t>(n));
    size_t k = 1;
    for (int i = 0; i < n; ++i) {
        const double want = at.back() * i / (n - 1);
        while (k + 1 < at.size() && at[k] < want) ++k;
        const double span = at[k] - at[k - 1];
        const double t = span > 0 ? std::clamp((want - at[k - 1]) / span, 0.0, 1.0) : 0;
        out[size_t(i)] = (1 - t) * curve[k - 1] + t * curve[k];
    }
    return out;
}

}  // namespace wetcurl
