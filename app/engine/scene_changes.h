// Changes of a scene that was read, as if its file had said so.
#pragma once

#include "solver/scene/scene.h"

namespace wetcurl {

// Which strands of a scene are simulated for the others to follow.
struct LowResolution {
    int each = 2;    // every so many roots each way of its grid,
    int guides = 0;  // or, above 0, so many, chosen
};
// The scene with those alone: what reading its file so returns. The low-resolution runs that networks start
// from are simulated with it. `kept_strands`: where to say which these are.
Scene low_resolution_of(const Scene& scene, const LowResolution& low = {},
                        std::vector<int>* kept_strands = nullptr);
// The scene with those strands alone, in this order.
Scene part_of_scene(const Scene& scene, const std::vector<int>& kept);

// These change the scene and its text.
// So many substeps a frame.
void set_substeps(Scene& scene, int substeps);
// A network, its file, in the place of Eq 11; the scene has [adhesion].
void set_adhesion_model(Scene& scene, const std::string& model);

}  // namespace wetcurl
