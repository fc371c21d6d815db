// A scene and its simulation: on a device, in a precision that the scene bears, with its adhesion network.
#pragma once

#include "app/engine/network_adhesion.h"
#include "app/engine/simulated_frames.h"

namespace wetcurl {

class SceneRun {
  public:
    // `device` as of --device; precision: "float" or "double". A scene too stiff for single precision runs in
    // double, and a warning says so. Throws Error where the device or the network is not there.
    // `begins`: false where it goes to a state at once, without settling and without a preroll.
    SceneRun(Scene scene, const std::string& device, const std::string& precision, int threads,
             bool begins = true);
    SceneRun(const SceneRun&) = delete;

    const Scene& scene() const { return scene_; }
    // For a caller who drives what moves in it, between frames.
    Scene& scene_to_drive() { return scene_; }
    Simulation& simulation() { return *simulation_; }
    const Simulation& simulation() const { return *simulation_; }
    const std::string& precision() const { return precision_; }
    // Of a run file with its frames.
    RunHeader header() const;

  private:
    Scene scene_;
    std::string device_, precision_;
    std::unique_ptr<AdhesionPredictor> adhesion_;  // null: Eq 11
    std::unique_ptr<Simulation> simulation_;
};

}  // namespace wetcurl
