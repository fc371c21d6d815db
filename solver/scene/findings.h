// What looks wrong about a scene when it is read: hair, head and water as they lie.
#pragma once

#include "solver/grooms/strand_findings.h"
#include "solver/scene/scene.h"

namespace wetcurl {

// Of the whole scene, after those that its groom has.
std::vector<Finding> findings_of(const Scene& scene);

// Logs warnings. Throws Error for the first finding of level error that the scene's `allow` does not name;
// `scene_name` begins its text.
void act_on(const std::vector<Finding>& findings, const Scene& scene, const std::string& scene_name);

}  // namespace wetcurl
