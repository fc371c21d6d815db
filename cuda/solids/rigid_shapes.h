// The shapes of a scene's rigid solids in a device's memory.
#pragma once

#include <vector>

#include "base/device_buffer.h"
#include "base/geometry/shapes.h"
#include "solver/scene/scene.h"

namespace wetcurl {

class RigidShapes {
  public:
    explicit RigidShapes(const Scene& scene) {
        std::vector<ShapeView> views;
        for (const auto& solid : scene.solids) {
            if (solid.deformation) continue;
            ShapeView view = view_of(solid.shape);
            if (const auto* level_set = std::get_if<std::shared_ptr<const LevelSet>>(&solid.shape)) {
                level_sets_.emplace_back((*level_set)->phi());
                view.grid.phi = level_sets_.back().data();
            }
            views.push_back(view);
        }
        views_ = DeviceBuffer<ShapeView>(views);
    }
    const ShapeView* data() const { return views_.data(); }  // in the scene's order
    size_t size() const { return views_.size(); }

  private:
    std::vector<DeviceBuffer<float>> level_sets_;
    DeviceBuffer<ShapeView> views_;
};

}  // namespace wetcurl
