// Turning triangles alike, part by part.
#include "base/geometry/mesh_winding.h"

#include <algorithm>
#include <cstring>
#include <map>
#include <numeric>
#include <unordered_map>

namespace wetcurl {

namespace {

using Corners = std::array<int, 3>;

struct HashOfPlace {
    size_t operator()(const Vec3f& p) const {
        uint32_t bits[3];
        const float each[3] = {p.x + 0.f, p.y + 0.f, p.z + 0.f};  // -0 is 0
        std::memcpy(bits, each, sizeof bits);
        uint64_t hash = 1469598103934665603ull;
        for (const uint32_t b : bits) hash = (hash ^ b) * 1099511628211ull;
        return size_t(hash ^ hash >> 29);
    }
};
struct SamePlace {
    bool operator()(const Vec3f& a, const Vec3f& b) const { return a.x == b.x && a.y == b.y && a.z == b.z; }
};

// (vertex): the first one of its place.
std::vector<int> first_of_place(const Mesh& mesh) {
    std::unordered_map<Vec3f, int, HashOfPlace, SamePlace> first;
    std::vector<int> out(mesh.vertices.size());
    for (size_t v = 0; v < out.size(); ++v)
        out[v] = first.try_emplace(mesh.vertices[v], int(v)).first->second;
    return out;
}

// A side of a triangle: its ends in order, and whether the triangle has them the other way round.
struct Side {
    int low, high;
    bool back;
    size_t triangle;
};

}  // namespace

std::string Winding::text() const {
    std::string out;
    if (doubled) out += "left out " + std::to_string(doubled) + " faces that are there twice";
    if (turned)
        out += (out.empty() ? "" : ", ") + std::string("turned ") + std::to_string(turned) +
               " faces round that were turned against their neighbours";
    return out;
}

Mesh consistently_wound(const Mesh& mesh, Winding* found) {
    Winding own;
    Winding& report = found ? *found : own;
    report = {};
    const std::vector<int> place = first_of_place(mesh);
    // By place, each set of corners once.
    std::vector<size_t> kept;
    std::vector<Corners> at;
    {
        std::vector<std::pair<Corners, size_t>> sets;
        for (size_t t = 0; t < mesh.triangles.size(); ++t) {
            Corners set;
            for (size_t c = 0; c < 3; ++c) set[c] = place[size_t(mesh.triangles[t][c])];
            std::sort(set.begin(), set.end());
            sets.emplace_back(set, t);
        }
        std::sort(sets.begin(), sets.end());
        for (size_t k = 0; k < sets.size(); ++k)
            if (k > 0 && sets[k].first == sets[k - 1].first)
                ++report.doubled;
            else
                kept.push_back(sets[k].second);
        std::sort(kept.begin(), kept.end());
    }
    for (const size_t t : kept) {
        Corners c = mesh.triangles[t];
        for (int& corner : c) corner = place[size_t(corner)];
        const auto corner = [&](size_t k) { return cast<double>(mesh.vertices[size_t(c[k])]); };
        const Vec3d ab = corner(1) - corner(0), ac = corner(2) - corner(0);
        report.no_area += !(norm(cross(ab, ac)) > 1e-12 * std::max(dot(ab, ab), dot(ac, ac)));
        at.push_back(c);
    }
    std::vector<Side> sides;
    for (size_t t = 0; t < at.size(); ++t)
        for (size_t c = 0; c < 3; ++c) {
            const int a = at[t][c], b = at[t][(c + 1) % 3];
            if (a != b) sides.push_back({std::min(a, b), std::max(a, b), a > b, t});
        }
    std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
        return std::tie(a.low, a.high, a.triangle) < std::tie(b.low, b.high, b.triangle);
    });
    // Neighbours across sides of two triangles; where more meet nobody can tell who goes on to whom.
    struct Neighbour {
        size_t triangle;
        bool against;  // turned the other way
    };
    std::vector<std::vector<Neighbour>> neighbours(at.size());
    for (size_t k = 0, end = 0; k < sides.size(); k = end) {
        while (end < sides.size() && sides[end].low == sides[k].low && sides[end].high == sides[k].high)
            ++end;
        report.open += end - k == 1;
        if (end - k != 2) continue;
        const Side &a = sides[k], &b = sides[k + 1];
        const bool against = a.back == b.back;
        neighbours[a.triangle].push_back({b.triangle, against});
        neighbours[b.triangle].push_back({a.triangle, against});
    }
    // Part by part: who is turned against the first, and the volume that the part then encloses.
    std::vector<char> part_seen(at.size(), 0), turned(at.size(), 0);
    std::vector<std::vector<size_t>> parts;
    std::vector<double> volumes;
    for (size_t first = 0; first < at.size(); ++first) {
        if (part_seen[first]) continue;
        std::vector<size_t> part{first};
        part_seen[first] = 1;
        for (size_t k = 0; k < part.size(); ++k)
            for (const Neighbour& n : neighbours[part[k]]) {
                if (part_seen[n.triangle]) continue;
                part_seen[n.triangle] = 1;
                turned[n.triangle] = char(turned[part[k]] != char(n.against));
                part.push_back(n.triangle);
            }
        // Most keep their way, so that a few wrong ones are turned and not the rest.
        const size_t against =
            size_t(std::count_if(part.begin(), part.end(), [&](size_t t) { return turned[t]; }));
        if (2 * against > part.size())
            for (const size_t t : part) turned[t] = !turned[t];
        Vec3d middle{0, 0, 0};
        for (const size_t t : part)
            for (const int c : at[t])
                middle += (1 / (3 * double(part.size()))) * cast<double>(mesh.vertices[size_t(c)]);
        double volume = 0;
        for (const size_t t : part) {
            const auto corner = [&](size_t c) {
                return cast<double>(mesh.vertices[size_t(at[t][c])]) - middle;
            };
            volume += (turned[t] ? -1 : 1) * dot(corner(0), cross(corner(1), corner(2))) / 6;
        }
        parts.push_back(std::move(part)), volumes.push_back(volume);
    }
    // Parts turned against each other are turned outward, all inward ones are as good as all outward ones.
    const auto largest = std::max_element(volumes.begin(), volumes.end(),
                                          [](double a, double b) { return std::abs(a) < std::abs(b); });
    const double way = largest != volumes.end() && *largest < 0 ? -1 : 1;
    // A sheet encloses next to nothing, and its sign says nothing.
    const double least = largest != volumes.end() ? 1e-6 * std::abs(*largest) : 0;
    for (size_t p = 0; p < parts.size(); ++p)
        if (way * volumes[p] < -least)
            for (const size_t t : parts[p]) turned[t] = !turned[t];
    report.turned = size_t(std::count(turned.begin(), turned.end(), char(1)));
    if (!report.changed()) return mesh;
    Mesh out{mesh.vertices, {}};
    for (size_t k = 0; k < kept.size(); ++k) {
        Corners t = mesh.triangles[kept[k]];
        if (turned[k]) std::swap(t[1], t[2]);
        out.triangles.push_back(t);
    }
    return out;
}

double share_without_sides(const Mesh& mesh, double apart) {
    const MeshDistance surface(mesh);
    const size_t step = std::max<size_t>(1, mesh.triangles.size() / 2000);
    double all = 0, unclear = 0;
    for (size_t t = 0; t < mesh.triangles.size(); t += step) {
        const auto corner = [&](size_t c) {
            return cast<double>(mesh.vertices[size_t(mesh.triangles[t][c])]);
        };
        const Vec3d twice = cross(corner(1) - corner(0), corner(2) - corner(0));
        const double area = norm(twice);
        if (!(area > 0)) continue;
        const Vec3d middle = (1.0 / 3) * (corner(0) + corner(1) + corner(2)),
                    half = (apart / 2 / area) * twice;
        all += area;
        const auto [outside, inside] = std::minmax({std::abs(surface.winding_number(middle + half)),
                                                    std::abs(surface.winding_number(middle - half))});
        // Where parts lie in one another both sides are inside.
        if (inside < 0.6 || (outside > 0.4 && outside < 0.6)) unclear += area;
    }
    return all > 0 ? unclear / all : 1;
}

}  // namespace wetcurl
