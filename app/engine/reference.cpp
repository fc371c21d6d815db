// The reference that runs are judged against.
#include "app/engine/reference.h"

#include <fmt/format.h>

#include <limits>

#include "app/engine/device.h"
#include "app/engine/scene_changes.h"

namespace wetcurl {

static Scene in_short_steps(Scene scene) {
    set_substeps(scene, Reference::substeps);
    return scene;
}

Reference::Reference(const Scene& scene, const std::string& device)
    : scene_(in_short_steps(scene)),
      simulation_(make_simulation_on(device, scene_, "double")),
      frames_(*simulation_, std::numeric_limits<int>::max()) {}

const RunFrame& Reference::next() {
    try {
        frames_.next(frame_);
    } catch (const Diverged& e) {
        throw Error(fmt::format("the reference, in double with {} substeps: {}", substeps, e.what()));
    }
    return frame_;
}

double distance_mm(const Strands& a, const Strands& b) {
    double sum = 0;
    for (size_t k = 0; k < a.points.size(); ++k)
        sum += norm(cast<double>(a.points[k]) - cast<double>(b.points[k]));
    return 1000 * sum / double(a.points.size());
}

}  // namespace wetcurl
