// How deep the groom lies in solids at rest, which contact allows.
#pragma once

#include <vector>

#include "solver/scene/scene.h"

namespace wetcurl {

// How deep each particle may lie in what moves with the roots: min(0, phi at rest) [m], (strand, particle);
// empty where nothing does.
std::vector<float> rest_depths_of(const Scene& scene);

}  // namespace wetcurl
