// Changes of a scene that was read.
#include "app/engine/scene_changes.h"

namespace wetcurl {

Scene low_resolution_of(const Scene& scene) {
    Scene low = scene;
    low.stride = 2 * scene.stride;
    std::vector<int> kept;
    low.groom = coarsened(scene.groom, 2, &kept);
    if (scene.riding) low.riding->roots = scene.riding->roots->kept(kept);
    if (low.groom.rest.count == 0) throw Error(scene.title + ": no strand is left in the groom");
    if (scene.saturation.empty()) return low;
    const long particles = scene.groom.rest.particles;
    low.saturation.clear();
    for (const int s : kept) {
        const auto strand = scene.saturation.begin() + s * particles;
        low.saturation.insert(low.saturation.end(), strand, strand + particles);
    }
    return low;
}

static void assign(Scene& scene, const std::string& assignment) {
    Config config = Config::parse(scene.text, scene.title, scene.folder);
    config.set(assignment);
    scene.text = config.text();
}

void set_substeps(Scene& scene, int substeps) {
    assign(scene, "integrator.substeps=" + std::to_string(substeps));
    scene.integrator.substeps = substeps;
    // The spring of the limit depends on the step.
    if (auto& limit = scene.term<StrainLimit>()) limit->stiffen(1 / (scene.fps * substeps), limit->others);
}

void set_adhesion_model(Scene& scene, const std::string& model) {
    assign(scene, "adhesion.model='" + model + "'");
    scene.adhesion_model = model;
    scene.files.push_back(model);
}

}  // namespace wetcurl
