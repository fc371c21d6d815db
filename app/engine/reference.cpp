// The reference that runs are judged against.
#include "app/engine/reference.h"

#include "app/engine/device.h"

namespace wetcurl {

static Scene in_short_steps(Scene scene) {
    scene.integrator.substeps = Reference::substeps;
    // As where the scene is read: as stiff as these steps want it.
    if (auto& limit = scene.term<StrainLimit>())
        limit->stiffen(1 / (scene.fps * scene.integrator.substeps), limit->others);
    return scene;
}

Reference::Reference(const Scene& scene, const std::string& device)
    : scene_(in_short_steps(scene)), simulation_(make_simulation_on(device, scene_, "double")) {}

const RunFrame& Reference::next() {
    if (begun_) simulation_->advance();
    begun_ = true;
    simulation_->snapshot(frame_);
    return frame_;
}

double distance_mm(const Strands& a, const Strands& b) {
    double sum = 0;
    for (size_t k = 0; k < a.points.size(); ++k)
        sum += norm(cast<double>(a.points[k]) - cast<double>(b.points[k]));
    return 1000 * sum / double(a.points.size());
}

}  // namespace wetcurl
