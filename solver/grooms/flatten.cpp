// Disks of triangles, and ARAP by local and global steps with a sparse Cholesky factor made once.
// Source: Liu 2008.
#include "solver/grooms/flatten.h"

#include <algorithm>
#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <map>
#include <queue>

namespace wetcurl {
namespace {

using Triple = std::array<int, 3>;

Vec3d vertex(const Mesh& mesh, int v) { return cast<double>(mesh.vertices[size_t(v)]); }

Vec3d centroid(const Mesh& mesh, int t) {
    const Triple& c = mesh.triangles[size_t(t)];
    return (1.0 / 3) * (vertex(mesh, c[0]) + vertex(mesh, c[1]) + vertex(mesh, c[2]));
}

// Across the edge that lies opposite to corner k of each triangle: the other triangle; -1 where there is none
// or more than one.
std::vector<Triple> triangle_neighbours(const Mesh& mesh) {
    std::map<std::pair<int, int>, std::vector<std::pair<int, int>>> sides;  // edge: (triangle, corner)
    for (int t = 0; t < int(mesh.triangles.size()); ++t)
        for (int k = 0; k < 3; ++k) {
            const int a = mesh.triangles[size_t(t)][size_t(k + 1) % 3],
                      b = mesh.triangles[size_t(t)][size_t(k + 2) % 3];
            sides[std::minmax(a, b)].push_back({t, k});
        }
    std::vector<Triple> across(mesh.triangles.size(), Triple{-1, -1, -1});
    for (const auto& [edge, two] : sides)
        if (two.size() == 2)
            for (int side : {0, 1})
                across[size_t(two[side].first)][size_t(two[side].second)] = two[1 - side].first;
    return across;
}

}  // namespace

std::vector<int> disk_of_triangles(const Mesh& mesh, const std::vector<char>& allowed, int seed) {
    const auto across = triangle_neighbours(mesh);
    std::vector<char> inside(mesh.triangles.size(), 0), used(mesh.vertices.size(), 0);
    // A triangle keeps the disk a disk if it touches it along one edge and brings a new vertex, or along two
    // edges.
    auto fits = [&](int t) {
        int edges = 0, free_corner = 0;
        for (int k = 0; k < 3; ++k)
            if (const int other = across[size_t(t)][size_t(k)]; other >= 0 && inside[size_t(other)]) {
                ++edges;
                free_corner = mesh.triangles[size_t(t)][size_t(k)];
            }
        return edges == 2 || (edges == 1 && !used[size_t(free_corner)]);
    };
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    queue.push({0, seed});
    std::vector<int> disk;
    while (!queue.empty()) {
        const auto [distance, t] = queue.top();
        queue.pop();
        if (inside[size_t(t)] || (!disk.empty() && !fits(t))) continue;
        inside[size_t(t)] = 1;
        disk.push_back(t);
        for (int v : mesh.triangles[size_t(t)]) used[size_t(v)] = 1;
        for (int other : across[size_t(t)])
            if (other >= 0 && !inside[size_t(other)] && allowed[size_t(other)])
                queue.push({distance + norm(centroid(mesh, other) - centroid(mesh, t)), other});
    }
    return disk;
}

Mesh submesh(const Mesh& mesh, const std::vector<int>& triangles, std::vector<int>* vertices) {
    std::vector<int> place(mesh.vertices.size(), -1), from;
    Mesh out;
    for (int t : triangles) {
        Triple corners = mesh.triangles[size_t(t)];
        for (int& v : corners) {
            if (place[size_t(v)] < 0) {
                place[size_t(v)] = int(from.size());
                from.push_back(v);
                out.vertices.push_back(mesh.vertices[size_t(v)]);
            }
            v = place[size_t(v)];
        }
        out.triangles.push_back(corners);
    }
    if (vertices) *vertices = from;
    return out;
}

namespace {

// A triangle in its own plane, corner k opposite to edge k.
struct FlatTriangle {
    Triple corner;
    Planar at[3];
    double cotangent[3];  // of the angle at corner k

    Planar edge(int k) const { return at[(k + 2) % 3] - at[(k + 1) % 3]; }
    double area() const { return 0.5 * std::abs(cross(edge(1), edge(2))); }
};

FlatTriangle flat_triangle(const Mesh& mesh, const Triple& corner, bool mirrored) {
    FlatTriangle out{corner, {}, {}};
    const Vec3d a = vertex(mesh, corner[0]), b = vertex(mesh, corner[1]) - a, c = vertex(mesh, corner[2]) - a;
    const double base = norm(b), along = base > 0 ? dot(b, c) / base : 0;
    const double height = std::sqrt(std::max(0.0, dot(c, c) - along * along));
    out.at[1] = {base, 0};
    out.at[2] = {along, mirrored ? -height : height};
    const double twice_area = base * height, longest = std::max({dot(b, b), dot(c, c), dot(c - b, c - b)});
    for (int k = 0; k < 3; ++k) {
        const Planar to_next = out.at[(k + 1) % 3] - out.at[k], to_last = out.at[(k + 2) % 3] - out.at[k];
        // A sliver's cotangents would swamp all others: it follows its neighbours with a token weight.
        out.cotangent[k] = twice_area > 1e-4 * longest ? dot(to_next, to_last) / twice_area : 1e-3;
    }
    return out;
}

Planar place_edge(const std::vector<Planar>& place, const FlatTriangle& t, int k) {
    return place[size_t(t.corner[(k + 2) % 3])] - place[size_t(t.corner[(k + 1) % 3])];
}

// The local step: the rotation (cos, sin) that turns the triangle nearest to its image, Eq 4 and 5.
Planar best_rotation(const std::vector<Planar>& place, const FlatTriangle& t) {
    double c = 0, s = 0;
    for (int k = 0; k < 3; ++k) {
        const Planar x = t.edge(k), u = place_edge(place, t, k);
        c += t.cotangent[k] * dot(x, u);
        s += t.cotangent[k] * cross(x, u);
    }
    const double n = std::hypot(c, s);
    return n > 0 ? Planar{c / n, s / n} : Planar{1, 0};
}

Planar turned(const Planar& rotation, const Planar& x) {
    return {rotation.x * x.x - rotation.y * x.y, rotation.y * x.x + rotation.x * x.y};
}

// Eq 2.
double energy(const std::vector<Planar>& place, const std::vector<FlatTriangle>& triangles) {
    double sum = 0;
    for (const auto& t : triangles) {
        const Planar rotation = best_rotation(place, t);
        for (int k = 0; k < 3; ++k) {
            const Planar off = place_edge(place, t, k) - turned(rotation, t.edge(k));
            sum += t.cotangent[k] * dot(off, off);
        }
    }
    return sum;
}

double signed_area(const std::vector<Planar>& place, const Triple& c) {
    return 0.5 * cross(place[size_t(c[1])] - place[size_t(c[0])], place[size_t(c[2])] - place[size_t(c[0])]);
}

// The matrix of Eq 6, one vertex held so that it has an inverse.
Eigen::SparseMatrix<double> laplacian(const std::vector<FlatTriangle>& triangles, int vertices) {
    std::vector<Eigen::Triplet<double>> entries{{0, 0, 1.0}};
    for (const auto& t : triangles)
        for (int k = 0; k < 3; ++k) {
            const int i = t.corner[(k + 1) % 3], j = t.corner[(k + 2) % 3];
            for (auto [row, column, sign] : {std::tuple{i, i, 1}, {j, j, 1}, {i, j, -1}, {j, i, -1}})
                entries.emplace_back(row, column, sign * t.cotangent[k]);
        }
    Eigen::SparseMatrix<double> matrix(vertices, vertices);
    matrix.setFromTriplets(entries.begin(), entries.end());
    return matrix;
}

// The right side of Eq 6 for the rotations that suit `place`.
Eigen::MatrixX2d right_side(const std::vector<Planar>& place, const std::vector<FlatTriangle>& triangles) {
    Eigen::MatrixX2d b = Eigen::MatrixX2d::Zero(Eigen::Index(place.size()), 2);
    b.row(0) << place[0].x, place[0].y;
    for (const auto& t : triangles) {
        const Planar rotation = best_rotation(place, t);
        for (int k = 0; k < 3; ++k) {
            const Planar x = t.cotangent[k] * turned(rotation, t.edge(k));
            b.row(t.corner[(k + 2) % 3]) += Eigen::RowVector2d(x.x, x.y);
            b.row(t.corner[(k + 1) % 3]) -= Eigen::RowVector2d(x.x, x.y);
        }
    }
    return b;
}

// Sum of (singular value - 1)^2 of the map of a triangle: with the mean rotation c and the mean reflection d
// of its complex derivative they are |c| + |d| and |c| - |d|.
double squared_distortion(const std::vector<Planar>& place, const FlatTriangle& t) {
    const Planar x1 = t.at[1] - t.at[0], x2 = t.at[2] - t.at[0];
    const Planar u1 = place[size_t(t.corner[1])] - place[size_t(t.corner[0])],
                 u2 = place[size_t(t.corner[2])] - place[size_t(t.corner[0])];
    const double det = cross(x1, x2);
    const Planar du = (1 / det) * (x2.y * u1 - x1.y * u2), dv = (1 / det) * (x1.x * u2 - x2.x * u1);
    const double c = 0.5 * std::hypot(du.x + dv.y, du.y - dv.x),
                 d = 0.5 * std::hypot(du.x - dv.y, du.y + dv.x);
    return (c + d - 1) * (c + d - 1) + (c - d - 1) * (c - d - 1);
}

}  // namespace

Flattening flatten_arap(const Mesh& disk, const std::vector<Planar>& guess) {
    if (guess.size() != disk.vertices.size() || disk.triangles.empty())
        throw Error("flattening: found " + std::to_string(guess.size()) + " places and " +
                    std::to_string(disk.triangles.size()) + " triangles, allowed one place for each of " +
                    std::to_string(disk.vertices.size()) + " vertices and 1 triangle or more");
    Flattening out{guess};
    double area = 0;
    for (const auto& c : disk.triangles) area += signed_area(out.place, c);
    std::vector<FlatTriangle> triangles;
    for (const auto& c : disk.triangles) triangles.push_back(flat_triangle(disk, c, area < 0));

    Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(laplacian(triangles, int(out.place.size())));
    if (factor.info() != Eigen::Success) throw Error("flattening: the patch of the scalp is not connected");
    double whole = 0;
    for (const auto& t : triangles) whole += t.area();
    constexpr int most_iterations = 500;
    double before = energy(out.place, triangles);
    while (out.iterations < most_iterations) {
        const Eigen::MatrixX2d solved = factor.solve(right_side(out.place, triangles));
        for (size_t v = 0; v < out.place.size(); ++v)
            out.place[v] = {solved(Eigen::Index(v), 0), solved(Eigen::Index(v), 1)};
        ++out.iterations;
        const double now = energy(out.place, triangles);
        if (before - now < 1e-5 * before || now < 1e-14 * whole) break;
        before = now;
    }
    double squares = 0;
    for (const auto& t : triangles) {
        if (t.area() > 0) squares += t.area() * squared_distortion(out.place, t);
        out.flipped += signed_area(out.place, t.corner) * (area < 0 ? -1 : 1) < 0;
    }
    out.distortion = std::sqrt(squares / (2 * whole));
    return out;
}

}  // namespace wetcurl
