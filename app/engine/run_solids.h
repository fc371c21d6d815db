// The solids of a run, from the scene that its cache carries: as meshes to draw and as distances to measure.
#pragma once

#include <functional>
#include <vector>

#include "base/geometry/mesh.h"
#include "base/run_cache.h"

namespace wetcurl {

// A mesh in its own coordinates and where it stands in the world.
struct PosedMesh {
    Mesh mesh;
    Pose pose;
};

// Every solid of the run's scene where it stands at `time` [s]; those attached to the head follow the frame's
// head.
std::vector<PosedMesh> solids_of(const RunHeader& header, const RunFrame& frame, double time);

// Signed distance [m] of a world point to the nearest solid, negative inside, with the head at the given
// pose, at a time [s]; `loose`: of those alone that are not attached to the head. Empty where there are none.
// Asked from one thread at a time, and best in the order of times: a solid that deforms has its level set
// rebuilt for each.
std::function<float(const Vec3f&, const Pose&, double)> solid_distance_of(const RunHeader& header,
                                                                          bool loose = false);

}  // namespace wetcurl
