// What is seen of wet hair: p^w, strands drawn together (Eq 10), projected out of solids and led around those
// that they would cross. The simulation shows its frames through it, and so does whoever puts learned strands
// in its place.
#pragma once

#include <memory>
#include <optional>

#include "solver/cohesion/cohesion_pass.h"
#include "solver/scene/scene.h"
#include "solver/solids/contact.h"

namespace wetcurl {

class Display {
  public:
    // For a scene with [cohesion]; the scene must outlive it.
    explicit Display(const Scene& scene) : Display(scene, scene.saturation) {}
    // The same where `saturation` (strand, particle) lives, which must outlive it too.
    Display(const Scene& scene, const std::vector<float>& saturation);
    // Volumes as `saturation` has them now; dry_mass (strand, particle) [kg].
    void take_up_water(const std::vector<double>& dry_mass);
    // Positions p of all strands of the scene's groom become p^w, at a pose of the head and a time [s].
    // `surfaces`: of each deforming solid, in the scene's order; null: there is none.
    void apply(Strands& p, const Pose& head, double time, const MovingGrid* surfaces = nullptr);

    double neighbours_mean() const { return cohesion_.neighbours_mean(); }
    double list_seconds() const { return cohesion_.list_seconds(); }
    double seconds() const { return seconds_; }  // of the last call, lists included
    size_t bytes() const;

  private:
    const Scene& scene_;
    const std::vector<float>& saturation_;
    std::vector<float> volume_, rest_depth_;  // (strand, particle)
    std::vector<ShapeView> shapes_;           // (solid)
    std::vector<PosedSolid<float, ShapeView>> solids_;
    CohesionPass cohesion_;
    double seconds_ = 0;
};

}  // namespace wetcurl
