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

// Triangles too few to share out among threads.
constexpr int alone = 1000;

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

void MeshDistance::rebuild(const Mesh& mesh) {
    given_.resize(mesh.triangles.size());
#pragma omp parallel for schedule(static) if (given_.size() > size_t(alone))
    for (size_t t = 0; t < given_.size(); ++t) {
        const auto corner = [&](size_t k) {
            return cast<double>(mesh.vertices[size_t(mesh.triangles[t][k])]);
        };
        const Vec3d a = corner(0), b = corner(1), c = corner(2);
        const Vec3d ab = b - a, ac = c - a, bc = c - b, twice = cross(ab, ac), area = 0.5 * twice;
        const double longest = std::max({dot(ab, ab), dot(ac, ac), dot(bc, bc)});
        given_[t] = {{a, b, c}, (1.0 / 3) * (a + b + c), area, norm(area), norm(twice) > 1e-12 * longest};
    }
    original_.clear();
    for (size_t t = 0; t < given_.size(); ++t)
        if (given_[t].counts) original_.push_back(int(t));
    if (original_.empty())
        throw Error("distance to a mesh: none of its " + std::to_string(given_.size()) +
                    " triangles has an area");
    nodes_.resize(original_.size());
    int used = 1;
#pragma omp parallel if (original_.size() > size_t(alone))
#pragma omp single
    build(0, 0, int(original_.size()), used);
    nodes_.resize(size_t(used));
    place_.assign(given_.size(), -1);
    triangles_.clear();
    for (int t : original_) {
        place_[size_t(t)] = int(triangles_.size());
        triangles_.push_back(given_[size_t(t)].corners);
    }
}

// Where nodes lie depends on who comes first, the tree that they make does not.
void MeshDistance::build(int node, int first, int count, int& used) {
    constexpr int leaf = 4;
    const std::span<int> members(original_.data() + first, size_t(count));
    nodes_[size_t(node)] = summary(members);
    if (count <= leaf) {
        nodes_[size_t(node)].first = first;
        nodes_[size_t(node)].count = count;
        return;
    }
    const Vec3d size = nodes_[size_t(node)].high - nodes_[size_t(node)].low;
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const int half = count / 2;
    std::nth_element(members.begin(), members.begin() + half, members.end(), [&](int s, int t) {
        return component(given_[size_t(s)].centroid, axis) < component(given_[size_t(t)].centroid, axis);
    });
    int children;
#pragma omp atomic capture
    {
        children = used;
        used += 2;
    }
    nodes_[size_t(node)].first = children;
    nodes_[size_t(node)].count = 0;
#pragma omp task default(shared) firstprivate(children, first, half) if (count > alone)
    build(children, first, half, used);
    build(children + 1, first + half, count - half, used);
#pragma omp taskwait
}

MeshDistance::Node MeshDistance::summary(std::span<const int> members) const {
    const Bounds none = empty_bounds();
    Node node{none.low, none.high, {0, 0, 0}, {0, 0, 0}, 0, 0, 0};
    double total = 0, farthest = 0;  // farthest: squared
    for (int t : members) {
        const auto& [a, b, c] = given_[size_t(t)].corners;
        const double size = given_[size_t(t)].size;
        node.area += given_[size_t(t)].area;
        node.centre += (size / 3) * (a + b + c);
        total += size;
        node.low = lower(node.low, lower(a, lower(b, c)));
        node.high = upper(node.high, upper(a, upper(b, c)));
    }
    node.centre = (1 / total) * node.centre;
    for (int t : members) {
        const auto& [a, b, c] = given_[size_t(t)].corners;
        for (const Vec3d& p : {a, b, c}) farthest = std::max(farthest, dot(p - node.centre, p - node.centre));
    }
    node.radius = std::sqrt(farthest);
    return node;
}

size_t MeshDistance::bytes() const {
    return given_.capacity() * sizeof(Given) + triangles_.capacity() * sizeof(Triangle) +
           (original_.capacity() + place_.capacity()) * sizeof(int) + nodes_.capacity() * sizeof(Node);
}

MeshDistance::Closest MeshDistance::closest(const Vec3d& x, int guess) const {
    return tree().closest(x, guess);
}
double MeshDistance::winding_number(const Vec3d& x) const { return tree().winding_number(x); }
bool MeshDistance::inside(const Vec3d& x) const { return tree().inside(x); }

}  // namespace wetcurl
