// Meshes as people have them, made such that a winding number tells inside from outside: faces that are there
// twice, parts that are turned against each other.
#pragma once

#include "base/geometry/mesh.h"

namespace wetcurl {

struct Winding {
    size_t doubled = 0;  // triangles left out, since another one has the same corners
    size_t turned = 0;   // triangles turned round
    size_t open = 0;     // edges of one triangle alone
    size_t no_area = 0;  // triangles of none, which stay
    bool changed() const { return doubled + turned > 0; }
    // "left out 320 faces that are there twice, turned 12 round".
    std::string text() const;
};

// The mesh with each face once, neighbours turned alike, and each part that is connected turned outward by
// the volume that it encloses. Vertices stay, those of the same place count as one. A mesh that is so already
// is returned as it is, triangle by triangle; one that is turned inward as a whole too, since an inside has a
// winding number of 1 or of -1.
Mesh consistently_wound(const Mesh& mesh, Winding* found = nullptr);

// The share of the surface on whose two sides, `apart` [m] from each other, winding numbers are not clearly 0
// and 1, so that nothing tells which way is out: sheets, shells thinner than that, and the rim of what is
// open.
double share_without_sides(const Mesh& mesh, double apart);

}  // namespace wetcurl
