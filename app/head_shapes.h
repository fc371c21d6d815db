// The solids of a scene as a network of displayed strands meets them. Ours.
#pragma once

#include "learn/learned_strands.h"
#include "solver/scene.h"

namespace wetcurl {

// What is attached to the head. Throws Error, naming `file`, where a solid is not, or deforms: nothing keeps
// the strands of such a network out of it, as it runs without Eq 10.
HeadShapes head_shapes_of(const Scene& scene, const std::string& file);

}  // namespace wetcurl
