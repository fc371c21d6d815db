// A part of a scalp laid flat: a disk of triangles grown over it, then as-rigid-as-possible parameterisation,
// Liu 2008, "A local/global approach to mesh parameterization", Eq 2, 4 and 6.
#pragma once

#include <vector>

#include "base/geometry/mesh.h"
#include "solver/grooms/planar.h"

namespace wetcurl {

// The triangles among `allowed` (one flag each) that a disk grown from triangle `seed` reaches, nearest
// first; indices of the mesh. The result is a topological disk, whatever the mesh: one rim, no hole, no
// handle.
std::vector<int> disk_of_triangles(const Mesh& mesh, const std::vector<char>& allowed, int seed);

// The triangles named, with their own vertices alone.
Mesh submesh(const Mesh& mesh, const std::vector<int>& triangles, std::vector<int>* vertices = nullptr);

struct Flattening {
    std::vector<Planar> place;  // (vertex) [m]
    double distortion = 0;      // rms over the area of (singular value - 1): 0 is an isometry
    int flipped = 0;            // triangles turned over
    int iterations = 0;
};

// Flattens a disk from a first guess (one place a vertex). Throws Error where the mesh and the guess do not
// fit.
Flattening flatten_arap(const Mesh& disk, const std::vector<Planar>& guess);

}  // namespace wetcurl
