// The head-fixed frame at each root: offsets expressed in it know neither the head's pose nor the place on
// the scalp. y is the scalp normal; x the rest strand's direction, root to tip, as far as it lies in
// the scalp. The whole strand gives the direction and not its first edge, since that one turns with the phase
// of the curl.
#pragma once

#include <vector>

#include "base/strands.h"

namespace wetcurl {

struct RootFrames {
    std::vector<Quatf> rotation;  // root frame to the head's, one a strand
    std::vector<Vec3f> root;      // in the head's frame [m]

    int count() const { return int(root.size()); }
    // Where the root of strand s is in the world.
    Vec3f root_at(int s, const Pose& head) const { return cast<float>(head(cast<double>(root[size_t(s)]))); }
    // Root frame of strand s to the world.
    Quatf rotation_at(int s, const Pose& head) const {
        return cast<float>(head.rotation * cast<double>(rotation[size_t(s)]));
    }
};

// Throws Error where `groom` holds other numbers of normals and strands.
RootFrames root_frames(const Groom& groom);

}  // namespace wetcurl
