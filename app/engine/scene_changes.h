// Changes of a scene that was read, as if its file had said so.
#pragma once

#include "solver/scene/scene.h"

namespace wetcurl {

// The scene with every second root each way of its groom: what reading its file at twice the stride returns.
// The low-resolution runs that networks start from are simulated with it.
Scene low_resolution_of(const Scene& scene);

// These change the scene and its text.
// So many substeps a frame.
void set_substeps(Scene& scene, int substeps);
// A network, its file, in the place of Eq 11; the scene has [adhesion].
void set_adhesion_model(Scene& scene, const std::string& model);

}  // namespace wetcurl
