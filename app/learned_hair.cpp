// A strand network on the hair of a scene.
#include "app/learned_hair.h"

#include "base/error.h"
#include "learn/network_module.h"
#include "solver/rest_state.h"

namespace wetcurl {

void require_solids_for(const ModelCard& card, const Scene& scene, const std::string& file) {
    if (card.target != "displayed") return;
    for (const Solid& solid : scene.solids)
        if (!solid.attached || solid.deformation)
            throw Error(
                file + ": solid '" + solid.name + "' " +
                (solid.deformation ? "deforms" : "is not attached to the head") +
                ", allowed for a network of displayed strands is what moves with the head; one trained "
                "with target = \"strands\" is kept out of every solid");
}

double reach_of(const Scene& scene) { return scene.cohesion ? scene.cohesion->h_c : 0; }

std::unique_ptr<LearnedStrands> learned_strands_of(const std::string& model, const Scene& scene,
                                                   const std::string& scene_file, const Groom& low,
                                                   const std::string& device, int threads) {
    const ModelCard card = network_module().card(model);
    if (card.codec != "strand")
        throw Error(model + ": found a model of codec " + card.codec + ", allowed is one of codec strand");
    require_solids_for(card, scene, scene_file);
    const Strands shape = shape_at_rest(scene);
    auto learned = network_module().load_strands(
        model, StrandCodec(scene.groom, low, scene.saturation, &shape, card.low == "wet", reach_of(scene)),
        low, device, threads);
    if (card.target == "displayed" && scene.has_attached_solid()) {
        HeadShapes head;
        for (const Solid& solid : scene.solids) head.shapes.push_back(solid.shape);
        head.depth = rest_depths_of(scene);
        learned->keep_outside(head);
    }
    return learned;
}

}  // namespace wetcurl
