// Root frames from the rest groom.
#include "learn/codec/root_frame.h"

#include <cmath>
#include <string>

#include "base/error.h"

namespace wetcurl {

// Turns y to unit n, and x as near to `along` as n allows; where `along` is (nearly) n, any x will do.
static Quatd frame_of(const Vec3d& n, const Vec3d& along) {
    const Quatd upright = minimal_rotation(Vec3d{0, 1, 0}, n);
    const Vec3d flat = along - dot(along, n) * n;
    if (norm(flat) < 0.05 * norm(along)) return upright;
    const Vec3d x = rotate(upright, Vec3d{1, 0, 0});
    return rotation_about(n, std::atan2(dot(cross(x, flat), n), dot(x, flat))) * upright;
}

RootFrames root_frames(const Groom& groom) {
    const int n = groom.rest.count, tip = groom.rest.particles - 1;
    if (int(groom.normal.size()) != n)
        throw Error("groom: found " + std::to_string(groom.normal.size()) + " scalp normals for " +
                    std::to_string(n) + " strands, allowed one a strand");
    RootFrames out;
    for (int s = 0; s < n; ++s) {
        const Vec3d root = cast<double>(groom.rest.at(s, 0));
        const Vec3d normal = normalized(cast<double>(groom.normal[size_t(s)]), Vec3d{0, 1, 0});
        out.rotation.push_back(cast<float>(frame_of(normal, cast<double>(groom.rest.at(s, tip)) - root)));
        out.root.push_back(groom.rest.at(s, 0));
    }
    return out;
}

}  // namespace wetcurl
