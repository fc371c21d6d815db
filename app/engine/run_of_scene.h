// Between scenes and run caches.
#pragma once

#include <memory>

#include "base/run_cache.h"
#include "solver/run/simulation.h"

namespace wetcurl {

// What a run cache says of the scene it was made from.
RunHeader header_of(const Scene& scene, const Simulation& simulation, const std::string& method);

// The scene of a file: TOML, or that of a run (.h5), with its relative paths where they were. Throws as
// load_scene and RunReader do.
Scene scene_of_file(const std::string& path, const SceneOptions& options);

// The scene that a run was made of, read once for each run and without the words that were said then. Its
// hair comes from the run where its file is gone. Throws as parse_scene does.
std::shared_ptr<const Scene> scene_of_run(const RunHeader& header);

// Of a frame of the run's scene.
int substeps_of(const RunHeader& run);

// h of Eq 16 [m]: the cohesion radius of the run's scene, or its default where the scene has no cohesion.
float support_radius_of(const RunHeader& run);

}  // namespace wetcurl
