// Rates of rotations.
#include "solver/motion/root_motion.h"

#include <cmath>

namespace wetcurl {

Vec3d angular_velocity(const Quatd& before, const Quatd& after, double dt) {
    Quatd d = after * conjugate(before);
    if (d.w < 0) d = {-d.w, -d.x, -d.y, -d.z};
    const Vec3d v{d.x, d.y, d.z};
    const double s = norm(v);
    return s > 0 ? (2 * std::atan2(s, d.w) / (s * dt)) * v : Vec3d{0, 0, 0};
}

}  // namespace wetcurl
