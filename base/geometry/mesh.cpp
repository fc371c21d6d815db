// Closest point and winding number over a bounding-volume hierarchy of triangles.
// Ericson 2005, 5.1.5; Van Oosterom and Strackee 1983, Eq 8; Barill 2018, Eq 6 (order 1).
#include "base/geometry/mesh.h"

#include <algorithm>
#include <cstdint>
#include <numbers>

namespace wetcurl {

namespace {

double component(const Vec3d& v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

Bounds empty_bounds() {
    constexpr double inf = std::numeric_limits<double>::infinity();
    return {{inf, inf, inf}, {-inf, -inf, -inf}};
}

// Halving 2^31 triangles leaves fewer levels than this; a level keeps one node waiting.
constexpr int deepest = 64;

double squared_distance_to_box(const Vec3d& x, const Vec3d& low, const Vec3d& high) {
    const Vec3d d = x - lower(upper(x, low), high);
    return dot(d, d);
}

// Barycentric weights of the point of triangle abc nearest to x.
Vec3d closest_weights(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& x) {
    const Vec3d ab = b - a, ac = c - a, ax = x - a, bx = x - b, cx = x - c;
    const double d1 = dot(ab, ax), d2 = dot(ac, ax), d3 = dot(ab, bx), d4 = dot(ac, bx), d5 = dot(ab, cx),
                 d6 = dot(ac, cx);
    if (d1 <= 0 && d2 <= 0) return {1, 0, 0};
    if (d3 >= 0 && d4 <= d3) return {0, 1, 0};
    if (d6 >= 0 && d5 <= d6) return {0, 0, 1};
    const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return {1 - d1 / (d1 - d3), d1 / (d1 - d3), 0};
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return {1 - d2 / (d2 - d6), 0, d2 / (d2 - d6)};
    const double bc = (d4 - d3) + (d5 - d6);
    if (va <= 0 && d4 >= d3 && d5 >= d6) return {0, 1 - (d4 - d3) / bc, (d4 - d3) / bc};
    const double sum = va + vb + vc;
    return {1 - vb / sum - vc / sum, vb / sum, vc / sum};
}

// Solid angle of abc seen from the origin (Van Oosterom and Strackee 1983, Eq 8).
double solid_angle(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
    const double la = norm(a), lb = norm(b), lc = norm(c);
    const double volume = dot(a, cross(b, c));
    // In the triangle's own plane the angle has no side.
    if (volume == 0) return 0;
    return 2 * std::atan2(volume, la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
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
    double least = std::numeric_limits<double>::infinity();
    Closest best;
    const auto visit = [&](int t) {
        const auto& [a, b, c] = triangles_[size_t(t)];
        const Vec3d w = closest_weights(a, b, c, x);
        const Vec3d p = w.x * a + w.y * b + w.z * c;
        if (const double d = dot(x - p, x - p); d < least) {
            least = d;
            best = {0, p, original_[size_t(t)], w};
        }
    };
    if (guess >= 0 && guess < int(place_.size()) && place_[size_t(guess)] >= 0) visit(place_[size_t(guess)]);
    struct Waiting {
        int node;
        double near;
    } stack[deepest];
    int top = 0;
    const auto near = [&](int n) {
        return squared_distance_to_box(x, nodes_[size_t(n)].low, nodes_[size_t(n)].high);
    };
    stack[top++] = {0, near(0)};
    while (top > 0) {
        const Waiting next = stack[--top];
        if (next.near >= least) continue;
        const Node& node = nodes_[size_t(next.node)];
        for (int t = node.first; t < node.first + node.count; ++t) visit(t);
        if (node.count > 0) continue;
        Waiting left{node.first, near(node.first)}, right{node.first + 1, near(node.first + 1)};
        if (left.near < right.near) std::swap(left, right);
        stack[top++] = left;  // the farther one waits
        stack[top++] = right;
    }
    best.distance = std::sqrt(least);
    return best;
}

double MeshDistance::winding_number(const Vec3d& x) const {
    // Barill 2018: a cluster seen from beyond beta times its radius is a dipole.
    constexpr double beta = 3;
    double sum = 0;
    int stack[deepest], top = 0;
    stack[top++] = 0;
    while (top > 0) {
        const Node& node = nodes_[size_t(stack[--top])];
        const Vec3d d = node.centre - x;
        if (const double r2 = dot(d, d); r2 > beta * beta * node.radius * node.radius) {
            sum += dot(d, node.area) / (r2 * std::sqrt(r2));
            continue;
        }
        for (int t = node.first; t < node.first + node.count; ++t) {
            const auto& [a, b, c] = triangles_[size_t(t)];
            sum += solid_angle(a - x, b - x, c - x);
        }
        if (node.count > 0) continue;
        stack[top++] = node.first;
        stack[top++] = node.first + 1;
    }
    return sum / (4 * std::numbers::pi);
}

}  // namespace wetcurl
