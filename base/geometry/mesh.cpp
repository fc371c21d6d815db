// A bounding-volume hierarchy of triangles.
#include "base/geometry/mesh.h"

#include <algorithm>
#include <cstdint>

namespace wetcurl {

namespace {

double component(const Vec3d& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

Bounds empty_bounds() {
    constexpr double inf = std::numeric_limits<double>::infinity();
    return {{inf, inf, inf}, {-inf, -inf, -inf}};
}

}  // namespace

int boundary_edges(const Mesh& mesh) {
    std::vector<uint64_t> edges;
    for (const auto& t : mesh.triangles)
        for (int k = 0; k < 3; ++k) {
            const auto [a, b] = std::minmax(t[k], t[(k + 1) % 3]);
            edges.push_back(uint64_t(a) << 32 | uint64_t(b));
        }
    std::sort(edges.begin(), edges.end());
    int lone = 0;
    for (size_t i = 0, end = 0; i < edges.size(); i = end) {
        while (end < edges.size() && edges[end] == edges[i]) ++end;
        lone += end - i == 1;
    }
    return lone;
}

Bounds bounding_box(const Mesh& mesh) {
    Bounds box = empty_bounds();
    for (const auto& t : mesh.triangles)
        for (int corner : t) {
            const Vec3d p = cast<double>(mesh.vertices[size_t(corner)]);
            box = {lower(box.low, p), upper(box.high, p)};
        }
    return box;
}

MeshDistance::MeshDistance(const Mesh& mesh) {
    std::vector<Triangle> given;
    for (size_t t = 0; t < mesh.triangles.size(); ++t) {
        const auto corner = [&](size_t k) {
            return cast<double>(mesh.vertices[size_t(mesh.triangles[t][k])]);
        };
        const Triangle abc{corner(0), corner(1), corner(2)};
        given.push_back(abc);
        // A triangle without an area has no surface to be near to, and no weights.
        const Vec3d ab = abc.b - abc.a, ac = abc.c - abc.a, bc = abc.c - abc.b;
        const double longest = std::max({dot(ab, ab), dot(ac, ac), dot(bc, bc)});
        if (norm(cross(ab, ac)) > 1e-12 * longest) original_.push_back(int(t));
    }
    if (original_.empty())
        throw Error("distance to a mesh: none of its " + std::to_string(given.size()) +
                    " triangles has an area");
    nodes_.reserve(original_.size());
    nodes_.emplace_back();
    build(0, 0, int(original_.size()), given);
    place_.assign(given.size(), -1);
    for (int t : original_) {
        place_[size_t(t)] = int(triangles_.size());
        triangles_.push_back(given[size_t(t)]);
    }
}

void MeshDistance::build(int node, int first, int count, const std::vector<Triangle>& given) {
    constexpr int leaf = 4;
    const auto begin = original_.begin() + first, end = begin + count;
    const auto centroid = [&](int t) {
        return (1.0 / 3) * (given[size_t(t)].a + given[size_t(t)].b + given[size_t(t)].c);
    };
    nodes_[size_t(node)] = summary(std::vector<int>(begin, end), given);
    if (count <= leaf) {
        nodes_[size_t(node)].first = first;
        nodes_[size_t(node)].count = count;
        return;
    }
    const Vec3d size = nodes_[size_t(node)].high - nodes_[size_t(node)].low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const int half = count / 2;
    std::nth_element(begin, begin + half, end, [&](int s, int t) {
        return component(centroid(s), axis) < component(centroid(t), axis);
    });
    const int children = int(nodes_.size());
    nodes_[size_t(node)].first = children;
    nodes_[size_t(node)].count = 0;
    nodes_.resize(nodes_.size() + 2);
    build(children, first, half, given);
    build(children + 1, first + half, count - half, given);
}

MeshDistance::Node MeshDistance::summary(const std::vector<int>& members,
                                         const std::vector<Triangle>& given) {
    const Bounds none = empty_bounds();
    Node node{none.low, none.high, {0, 0, 0}, {0, 0, 0}, 0, 0, 0};
    double total = 0;
    for (int t : members) {
        const auto& [a, b, c] = given[size_t(t)];
        const Vec3d area = 0.5 * cross(b - a, c - a);
        node.area += area;
        node.centre += (norm(area) / 3) * (a + b + c);
        total += norm(area);
        node.low = lower(node.low, lower(a, lower(b, c)));
        node.high = upper(node.high, upper(a, upper(b, c)));
    }
    node.centre = (1 / total) * node.centre;
    for (int t : members)
        for (const Vec3d& p : {given[size_t(t)].a, given[size_t(t)].b, given[size_t(t)].c})
            node.radius = std::max(node.radius, norm(p - node.centre));
    return node;
}

MeshDistance::Closest MeshDistance::closest(const Vec3d& x, int guess) const {
    return tree().closest(x, guess);
}
double MeshDistance::winding_number(const Vec3d& x) const { return tree().winding_number(x); }
bool MeshDistance::inside(const Vec3d& x) const { return tree().inside(x); }

}  // namespace wetcurl
