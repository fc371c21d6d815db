// Solids for networks of displayed strands.
#include "app/head_shapes.h"

#include "base/error.h"
#include "solver/rest_state.h"

namespace wetcurl {

HeadShapes head_shapes_of(const Scene& scene, const std::string& file) {
    HeadShapes out;
    for (const Solid& solid : scene.solids) {
        if (!solid.attached || solid.deformation)
            throw Error(
                file + ": solid '" + solid.name + "' " +
                (solid.deformation ? "deforms" : "is not attached to the head") +
                ", allowed for a network of displayed strands is what moves with the head; one trained "
                "with target = \"strands\" is kept out of every solid");
        out.shapes.push_back(solid.shape);
    }
    if (!out.shapes.empty()) out.depth = rest_depths_of(scene);
    return out;
}

}  // namespace wetcurl
