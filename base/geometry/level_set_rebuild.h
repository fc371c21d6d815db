// Rebuilding the level set of a moving mesh in a narrow band, node by node over plain arrays, for any device.
// From coarse lattices to fine ones: a node gathers from coarser lattices and writes its own slot.
#pragma once

#include <array>

#include "base/geometry/level_set.h"

namespace wetcurl {

// Where the distances of a moving mesh are wanted.
struct NarrowBand {
    // `box` [m], padded as LevelSet's; `width` [m], as asked for. Throws Error as LevelSet does.
    NarrowBand(const Mesh& mesh, const Bounds& box, double spacing, double width);
    DistanceGrid grid;  // phi is null
    double width;       // [m] from the surface, and a cell
    bool closed;        // the mesh
    size_t nodes() const { return size_t(grid.nx) * size_t(grid.ny) * size_t(grid.nz); }
};

struct LevelSetRebuild {
    // Of lattices, in cells, and so are half of it and so on; every node of this one is exact.
    static constexpr int coarsest_step = 8;

    NarrowBand band;
    double per_second;                        // 1 / span; 0: at rest
    const std::array<int, 3>* corners;        // (triangle of the mesh)
    const Vec3f *vertices_before, *vertices;  // at the span's begin and end [m]
    // (nz, ny, nx)
    float* phi;       // [m]
    Vec3f* velocity;  // [m/s]
    int* triangle;    // nearest one, or one near it

    // Node (i, j, k) of the lattice of `step` cells, once the coarser one's are all set; theirs stay as they
    // are. Surface: of `vertices`, a MeshDistance or what a device has in its place. Whether it took the
    // exact distance.
    template <class Surface>
    WETCURL_HD bool set(const Surface& surface, int step, int i, int j, int k) const {
        if (step < coarsest_step && (i | j | k) % (2 * step) == 0) return false;
        const Node node = node_at(step, i, j, k);
        float sum = 0, farthest = 0, least = std::numeric_limits<float>::infinity();
        bool inside = false, outside = false;
        Vec3f parents_velocity{0, 0, 0};
        int nearest = -1;
        for (int p = 0; p < node.parents; ++p) {
            const size_t at = node.parent[p];
            const float there = phi[at];
            sum += there, parents_velocity += velocity[at];
            farthest = maximum(farthest, std::abs(there));
            (there < 0 ? inside : outside) = true;
            if (std::abs(there) < least) least = std::abs(there), nearest = triangle[at];
        }
        // Nodes of this lattice within band + sqrt(3) (step - 1) h of the surface are exact: then those
        // around a node that should be, of the next coarser lattice, were exact too and none of them is
        // farther than this.
        const float reach =
            float(band.width + std::numbers::sqrt3 * (2 * step - 1) * double(band.grid.spacing));
        // Where an open mesh lacks a surface the sign jumps far from it: no mean across.
        if (farthest <= reach || (inside && outside)) {
            take_exact(surface, node, nearest, !(inside && outside));
            return true;
        }
        const float share = 1 / float(node.parents);
        phi[node.index] = share * sum;
        velocity[node.index] = share * parents_velocity;
        triangle[node.index] = nearest;
        return false;
    }

  private:
    // And those of the next coarser lattice around it: 2, 4 or 8, all equally far.
    struct Node {
        size_t index;
        Vec3d x;  // [m]
        size_t parent[8];
        int parents;
        double apart;  // [m] from each of them
    };
    WETCURL_HD Node node_at(int step, int i, int j, int k) const {
        const double h = double(band.grid.spacing);
        const auto at = [&](int a, int b, int c) {
            return (size_t(c) * size_t(band.grid.ny) + size_t(b)) * size_t(band.grid.nx) + size_t(a);
        };
        Node node{at(i, j, k),
                  cast<double>(band.grid.origin) + h * Vec3d{double(i), double(j), double(k)},
                  {},
                  0,
                  0};
        if (step == coarsest_step) return node;
        // Half a coarse cell back and on, along the axes on which the node lies between coarse ones.
        const int di = i % (2 * step), dj = j % (2 * step), dk = k % (2 * step);
        for (int c = k - dk; c <= k + dk; c += 2 * step)
            for (int b = j - dj; b <= j + dj; b += 2 * step)
                for (int a = i - di; a <= i + di; a += 2 * step) node.parent[node.parents++] = at(a, b, c);
        node.apart = h * std::sqrt(double(di * di + dj * dj + dk * dk));
        return node;
    }

    // `alike`: the parents' signs.
    template <class Surface>
    WETCURL_HD void take_exact(const Surface& surface, const Node& node, int guess, bool alike) const {
        const auto nearest = surface.closest(node.x, guess);
        const float distance = float(nearest.distance);
        // No way that is shorter than both distances together meets the surface, so that the sign is the same
        // at its ends. That of an open mesh changes without it, but between parents that differ.
        float sign = 0;
        for (int p = 0; (band.closed || alike) && sign == 0 && p < node.parents; ++p) {
            const float there = phi[node.parent[p]];
            if (double(std::abs(there)) + nearest.distance > 1.00001 * node.apart) sign = there < 0 ? -1 : 1;
        }
        if (sign == 0) sign = surface.inside(node.x) ? -1 : 1;
        phi[node.index] = sign * distance;
        triangle[node.index] = nearest.triangle;
        Vec3d moved{0, 0, 0};
        const auto& of = corners[nearest.triangle];
        const double weights[] = {nearest.barycentric.x, nearest.barycentric.y, nearest.barycentric.z};
        for (size_t c = 0; c < 3; ++c)
            moved += weights[c] * (cast<double>(vertices[of[c]]) - cast<double>(vertices_before[of[c]]));
        velocity[node.index] = cast<float>(per_second * moved);
    }
};

}  // namespace wetcurl
