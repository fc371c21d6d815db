// Changes of a scene that was read.
#include "app/engine/scene_changes.h"

#include "solver/grooms/guides.h"

namespace wetcurl {

// What a scene has for each strand, of those that were kept; its groom has them already.
static void keep_strands(Scene& scene, const std::vector<int>& kept) {
    if (scene.groom.rest.count == 0) throw Error(scene.title + ": no strand is left in the groom");
    if (scene.riding) scene.riding->roots = scene.riding->roots->kept(kept);
    const std::vector<double> thickness = std::move(scene.thickness);
    const std::vector<float> saturation = std::move(scene.saturation);
    scene.thickness.clear(), scene.saturation.clear();
    const long particles = scene.groom.rest.particles;
    for (const int s : kept) {
        if (!thickness.empty()) scene.thickness.push_back(thickness[size_t(s)]);
        if (saturation.empty()) continue;
        const auto strand = saturation.begin() + s * particles;
        scene.saturation.insert(scene.saturation.end(), strand, strand + particles);
    }
}

Scene low_resolution_of(const Scene& scene, const LowResolution& resolution, std::vector<int>* kept_strands) {
    Scene low = scene;
    std::vector<int> kept;
    if (resolution.guides > 0) {
        low.guides = resolution.guides;
        kept = chosen_guides(scene.groom, low.guides);
        low.groom = part_of(scene.groom, kept);
    } else {
        low.stride = resolution.each * scene.stride;
        low.groom = coarsened(scene.groom, resolution.each, &kept);
    }
    keep_strands(low, kept);
    if (kept_strands) *kept_strands = std::move(kept);
    return low;
}

Scene part_of_scene(const Scene& scene, const std::vector<int>& kept) {
    Scene part = scene;
    part.groom = part_of(scene.groom, kept);
    keep_strands(part, kept);
    return part;
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
