// Between scenes and run caches.
#include "app/engine/run_of_scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "solver/chain/scene_checks.h"

namespace wetcurl {

RunHeader header_of(const Scene& scene, const Simulation& simulation, const std::string& method) {
    RunHeader h;
    h.scene = scene.text;
    h.scene_folder = scene.folder;
    h.method = method;
    h.fps = scene.fps;
    h.seed = scene.seed;
    h.groom = scene.groom;
    h.stride = scene.stride;
    h.saturation = scene.saturation;
    h.energy_kinds = simulation.energy_kinds;
    h.stages = simulation.stages;
    const Presence presence = presence_of(scene);
    h.terms_present = fmt::format("{}", fmt::join(presence.present, ", "));
    h.terms_absent = fmt::format("{}", fmt::join(presence.absent, ", "));
    return h;
}

Scene scene_of_file(const std::string& path, const SceneOptions& options) {
    if (!path.ends_with(".h5") && !is_hdf5(path)) return load_scene(path, options);
    const RunReader run(path);
    Scene scene = parse_scene(run.header().scene, path, run.header().scene_folder, options);
    scene.files.push_back(path);
    return scene;
}

int substeps_of(const RunHeader& run) {
    Integrator integrator;
    read_parameters(integrator, Integrator::parameters,
                    Config::parse(run.scene, scene_name(run), run.scene_folder).root().table("integrator"));
    return integrator.substeps;
}

float support_radius_of(const RunHeader& run) {
    Cohesion cohesion;
    read_parameters(cohesion, Cohesion::parameters,
                    Config::parse(run.scene, scene_name(run), run.scene_folder).root().table("cohesion"));
    return float(cohesion.h_c);
}

}  // namespace wetcurl
