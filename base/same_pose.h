// Whether two poses are the same.
#pragma once

#include <cmath>

#include "base/vec3.h"

namespace wetcurl {

// To within `tolerance` [m], and as much of a radian.
inline bool same_pose(const Pose& a, const Pose& b, double tolerance) {
    const Quatd p = a.rotation, q = b.rotation;
    const double cosine = std::abs(p.w * q.w + p.x * q.x + p.y * q.y + p.z * q.z);
    return norm(a.translation - b.translation) < tolerance && 1 - cosine < tolerance * tolerance;
}

}  // namespace wetcurl
