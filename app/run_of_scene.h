// What a run cache says of the scene it was made from. Ours.
#pragma once

#include "base/run_cache.h"
#include "solver/simulation.h"

namespace wetcurl {

RunHeader header_of(const Scene& scene, const Simulation& simulation, const std::string& method);

}  // namespace wetcurl
