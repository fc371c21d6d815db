// A head with neck and shoulders, our own, as smooth unions of ellipsoids and round cones: `shape = "head"`.
#pragma once

#include "base/geometry/mesh.h"

namespace wetcurl {

// In body coordinates: the middle of the skull is the origin, y is up, the face looks along +z, and the skull
// is as large as a ball of `radius` [m] (an adult's: 0.095). Lengths below scale with it.
//
// Below 0 inside, 0 on the surface, above outside; its gradient there is about 1 long, elsewhere it is no
// exact distance. Those are a LevelSet's, of the mesh.
double bust_at(const Vec3d& x, double radius = 0.095);

// The surface where bust_at is 0, closed, triangles outward; vertices about `spacing` [m] apart, 0: a 36th of
// the radius. Throws Error for a radius or a spacing below 0, and for a spacing too fine for memory.
Mesh bust_mesh(double radius = 0.095, double spacing = 0);

// Whether hair grows in `direction` (unit) from the middle of the skull: above brow and temples, round the
// ears, down to the nape. As the angle from straight up at which it ends [rad].
double hairline(const Vec3d& direction);

}  // namespace wetcurl
