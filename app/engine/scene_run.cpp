// A scene and its simulation.
#include "app/engine/scene_run.h"

#include <fmt/format.h>

#include "app/engine/device.h"
#include "app/engine/run_of_scene.h"
#include "base/log.h"
#include "solver/chain/scene_checks.h"

namespace wetcurl {

SceneRun::SceneRun(Scene scene, const std::string& device, const std::string& precision, int threads,
                   bool begins)
    : scene_(std::move(scene)), device_(device), precision_(trusted_precision(scene_, precision)) {
    if (precision_ != precision)
        log_warning(fmt::format(
            "(h² k + h c) / m is {:.2g}, above what single precision can factor (1e5): running in double",
            stiffness_number(scene_)));
    if (!begins) scene_.integrator.settle = scene_.preroll = 0;
    simulation_ = make_simulation_on(device, scene_, precision_);
    adhesion_ = adhesion_predictor_of(scene_, threads);
    simulation_->use_adhesion_predictor(adhesion_.get());
}

RunHeader SceneRun::header() const {
    RunHeader header =
        header_of(scene_, *simulation_, method_of(scene_) + (adhesion_ ? ", adhesion learned" : ""));
    header.device = device_;
    return header;
}

}  // namespace wetcurl
