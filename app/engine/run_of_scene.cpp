// Between scenes and run caches.
#include "app/engine/run_of_scene.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <map>
#include <tuple>

#include "base/log.h"
#include "solver/chain/scene_checks.h"
#include "solver/scene/findings.h"

namespace wetcurl {

RunHeader header_of(const Scene& scene, const Simulation& simulation, const std::string& method) {
    RunHeader h;
    h.scene = scene.text;
    h.scene_folder = scene.folder;
    h.method = method;
    h.fps = scene.fps;
    h.seed = scene.seed;
    h.groom = scene.groom;
    h.stride = scene.stride, h.guides = scene.guides;
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
    if (options.findings_stop) act_on(findings_of(scene), scene, path);
    scene.files.push_back(path);
    return scene;
}

std::shared_ptr<const Scene> scene_of_run(const RunHeader& header) {
    // Of text, stride and guides.
    static std::map<std::tuple<std::string, int, int>, std::shared_ptr<const Scene>> known;
    auto& scene = known[{header.scene, header.stride, header.guides}];
    if (!scene) {
        const QuietLog quiet;
        SceneOptions options;
        options.stride = header.stride, options.guides = header.guides, options.start = header.start;
        const auto read = [&] {
            return std::make_shared<Scene>(
                parse_scene(header.scene, scene_name(header), header.scene_folder, options));
        };
        try {
            scene = read();
        } catch (const Error&) {
            // The file of its hair is gone; the run has it.
            Brought brought;
            for (int s = 0; s < header.groom.rest.count; ++s) {
                const Vec3f* strand = header.groom.rest.strand(s);
                auto& points = brought.strands.emplace_back();
                for (int i = 0; i < header.groom.rest.particles; ++i)
                    points.push_back(cast<double>(strand[i]));
            }
            options.brought = &brought, options.stride = 1, options.guides = 0;
            scene = read();
        }
    }
    return scene;
}

int substeps_of(const RunHeader& run) {
    Integrator integrator;
    read_parameters(integrator, Integrator::parameters,
                    Config::parse(run.scene, scene_name(run), run.scene_folder).root().table("integrator"));
    return integrator.substeps;
}

float support_radius_of(const RunHeader& run) {
    const Table table =
        Config::parse(run.scene, scene_name(run), run.scene_folder).root().table(Cohesion::table);
    Cohesion cohesion;
    read_parameters(cohesion, Cohesion::parameters, table);
    cohesion.complete(table, false);
    return float(cohesion.h_c);
}

}  // namespace wetcurl
