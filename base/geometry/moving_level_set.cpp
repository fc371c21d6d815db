// Rebuilding from coarse lattices to fine ones; a node gathers from coarser lattices and writes its own slot.
#include "base/geometry/moving_level_set.h"

#include <algorithm>
#include <numbers>

namespace wetcurl {

namespace {

constexpr int coarsest_step = 8;  // of lattices, in cells; every node of this one is exact

}  // namespace

// A node of the lattice at hand and those of the next coarser one around it: 2, 4 or 8, all equally far.
struct MovingLevelSet::Node {
    size_t index;
    Vec3d x;  // [m]
    size_t parent[8];
    int parents = 0;
    double apart = 0;  // [m] from each of them
};

MovingLevelSet::MovingLevelSet(Mesh mesh, const Bounds& box, double spacing, double band)
    : mesh_(std::move(mesh)),
      layout_(laid_over(box, spacing, "the box of a moving mesh", coarsest_step)),
      // The corners of a cell on the rim lie a diagonal beyond.
      band_(band + 2 * double(layout_.spacing)),
      closed_(boundary_edges(mesh_) == 0) {
    const size_t nodes = size_t(layout_.nx) * size_t(layout_.ny) * size_t(layout_.nz);
    phi_.resize(nodes), velocity_.resize(nodes), triangle_.resize(nodes);
    hold(mesh_.vertices);
}

void MovingLevelSet::hold(const std::vector<Vec3f>& vertices) {
    mesh_.vertices = before_ = vertices;
    seconds_ = 0;
    build();
    phi_before_ = phi_;
}

void MovingLevelSet::advance(const std::vector<Vec3f>& vertices, double seconds) {
    std::swap(phi_, phi_before_);
    std::swap(mesh_.vertices, before_);
    mesh_.vertices = vertices;
    seconds_ = seconds;
    build();
}

MovingGrid MovingLevelSet::grid(double share) const {
    MovingGrid grid{layout_, phi_before_.data(), velocity_.data(), float(share),
                    seconds_ > 0 ? float(1 / seconds_) : 0.f};
    grid.phi = phi_.data();
    return grid;
}

size_t MovingLevelSet::bytes() const {
    return (phi_.capacity() + phi_before_.capacity()) * sizeof(float) + velocity_.capacity() * sizeof(Vec3f) +
           triangle_.capacity() * sizeof(int);
}

// Calls visit(node) for each node of the lattice of `step` cells that the coarser one lacks, rows over
// threads.
template <class Visit>
void MovingLevelSet::for_lattice(int step, bool coarsest, Visit visit) {
    const int nx = layout_.nx, ny = layout_.ny, nz = layout_.nz;
    const double h = double(layout_.spacing);
#pragma omp parallel for collapse(2) schedule(dynamic, 4)
    for (int k = 0; k < nz; k += step)
        for (int j = 0; j < ny; j += step) {
            // Half a coarse cell back and on, along the axes on which the node lies between coarse ones.
            const int dk = k % (2 * step), dj = j % (2 * step);
            for (int i = 0; i < nx; i += step) {
                const int di = i % (2 * step);
                const auto at = [&](int a, int b, int c) {
                    return (size_t(c) * size_t(ny) + size_t(b)) * size_t(nx) + size_t(a);
                };
                Node node{at(i, j, k),
                          cast<double>(layout_.origin) + h * Vec3d{double(i), double(j), double(k)},
                          {}};
                if (!coarsest) {
                    if (di + dj + dk == 0) continue;
                    for (int c = k - dk; c <= k + dk; c += 2 * step)
                        for (int b = j - dj; b <= j + dj; b += 2 * step)
                            for (int a = i - di; a <= i + di; a += 2 * step)
                                node.parent[node.parents++] = at(a, b, c);
                    node.apart = h * std::sqrt(double(di * di + dj * dj + dk * dk));
                }
                visit(node);
            }
        }
}

void MovingLevelSet::take_exact(const MeshDistance& surface, const Node& node, int guess, bool alike) {
    const auto nearest = surface.closest(node.x, guess);
    const float distance = float(nearest.distance);
    // No way that is shorter than both distances together meets the surface, so that the sign is the same at
    // its ends. That of an open mesh changes without it, but between parents that differ.
    float sign = 0;
    for (int p = 0; (closed_ || alike) && sign == 0 && p < node.parents; ++p) {
        const float there = phi_[node.parent[p]];
        if (double(std::abs(there)) + nearest.distance > 1.00001 * node.apart) sign = there < 0 ? -1 : 1;
    }
    if (sign == 0) sign = surface.inside(node.x) ? -1 : 1;
    phi_[node.index] = sign * distance;
    triangle_[node.index] = nearest.triangle;
    Vec3d moved{0, 0, 0};
    const auto& corners = mesh_.triangles[size_t(nearest.triangle)];
    const double weights[] = {nearest.barycentric.x, nearest.barycentric.y, nearest.barycentric.z};
    for (size_t c = 0; c < 3; ++c) {
        const size_t v = size_t(corners[c]);
        moved += weights[c] * (cast<double>(mesh_.vertices[v]) - cast<double>(before_[v]));
    }
    velocity_[node.index] = cast<float>((seconds_ > 0 ? 1 / seconds_ : 0) * moved);
}

void MovingLevelSet::build() {
    const MeshDistance surface(mesh_);
    exact_ = 0;
    for (int step = coarsest_step; step > 0; step /= 2) {
        // Nodes of this lattice within band + sqrt(3) (step - 1) h of the surface are exact: then those
        // around a node that should be, of the next coarser lattice, were exact too and none of them is
        // farther than this.
        const float reach = float(band_ + std::numbers::sqrt3 * (2 * step - 1) * double(layout_.spacing));
        size_t count = 0;
        for_lattice(step, step == coarsest_step, [&](const Node& node) {
            float sum = 0, farthest = 0, least = std::numeric_limits<float>::infinity();
            bool inside = false, outside = false;
            Vec3f velocity{0, 0, 0};
            int triangle = -1;
            for (int p = 0; p < node.parents; ++p) {
                const size_t at = node.parent[p];
                const float phi = phi_[at];
                sum += phi, velocity += velocity_[at];
                farthest = std::max(farthest, std::abs(phi));
                (phi < 0 ? inside : outside) = true;
                if (std::abs(phi) < least) least = std::abs(phi), triangle = triangle_[at];
            }
            // Where an open mesh lacks a surface the sign jumps far from it: no mean across.
            if (farthest <= reach || (inside && outside)) {
                take_exact(surface, node, triangle, !(inside && outside));
#pragma omp atomic
                ++count;
                return;
            }
            const float share = 1 / float(node.parents);
            phi_[node.index] = share * sum;
            velocity_[node.index] = share * velocity;
            triangle_[node.index] = triangle;
        });
        exact_ += count;
    }
}

}  // namespace wetcurl
