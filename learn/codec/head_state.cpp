// The head's motion in its own frame.
#include "learn/codec/head_state.h"

namespace wetcurl {

HeadState::HeadState(const HeadWindow& heads, bool first)
    : rotation(cast<float>(heads.now.rotation)),
      translation(cast<float>(heads.now.translation)),
      first(first) {
    const Quatd to_head = conjugate(heads.now.rotation);
    auto in_head = [&](const Vec3d& v) { return cast<float>(rotate(to_head, v)); };
    gravity = in_head(heads.gravity), turning = in_head(heads.angular_velocity());
    const Vec3d at_origin = heads.acceleration({0, 0, 0});
    pull = in_head(at_origin);
    const Vec3d axes[3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    for (int a = 0; a < 3; ++a) pull_x[a] = in_head(heads.acceleration(axes[a]) - at_origin);
}

}  // namespace wetcurl
