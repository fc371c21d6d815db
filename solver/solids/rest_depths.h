// How deep the groom lies in solids at rest, which contact allows.
#pragma once

#include <vector>

#include "solver/scene/scene.h"

namespace wetcurl {

// How deep each particle may lie in what is attached to the head: min(0, phi at rest) [m], (strand,
// particle); empty where nothing is attached.
std::vector<float> rest_depths_of(const Scene& scene);

}  // namespace wetcurl
