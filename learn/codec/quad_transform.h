// From low-resolution strands and a geometry image to every high-resolution strand.
// Eq 18, 19. Differs: p = p* + h (h^4 sum_s sigma_s grad W(p* - p^s) gamma_s) kappa / N, since in print the
// shift is no length (kappa is 1 there, and so is h h^4 with units "printed"); 1/N becomes the stencil's
// weight, so that three roots (VI.G), edges and holes of the grid have their place; c* is the network's
// colour at the new root, else the network would move nothing; roots are exact (learn/codec/interpolate.h).
#pragma once

#include "base/shift_units.h"
#include "learn/codec/interpolate.h"

namespace wetcurl {

// paper: p* is the mean of the surrounding strands; core: core and detail (mean core and the nearest strand's
// detail).
enum class Reconstruction { paper, core };
// Throws Misuse for another name.
Reconstruction reconstruction_named(const std::string& name);

class QuadTransform {
  public:
    // saturation: (low strand, particle); support_radius h [m]; gain kappa, 0 or more.
    QuadTransform(Reconstruction form, Stencil stencil, const Groom& high, const Groom& low,
                  std::vector<float> saturation, float support_radius, float gain = 1,
                  ShiftUnits units = ShiftUnits::length);
    // p* of every high-resolution strand. low: world positions [m] of the low-resolution strands.
    void interpolate(const Strands& low, const Pose& head, Strands& out);
    // colours: one a high-resolution strand (Eq 14).
    void apply(const Strands& low, const Pose& head, const std::vector<Vec3f>& colours, Strands& out);
    // With the weights of each strand's neighbours that bring it nearest to `truth` (high strands) in the
    // mean over its particles: no colours, gain and units bring it nearer (learn/codec/transform_bound.h).
    void apply_nearest(const Strands& low, const Pose& head, const Strands& truth, Strands& out);

  private:
    // sigma_s grad W(p* - p^s) [1/m^4] of particle i of a strand that neighbour s pulls.
    Vec3f pull(const Strands& low, int s, int i, const Vec3f& p_star) const;
    Interpolator mean_;
    std::vector<float> saturation_;
    float support_radius_, gain_, unit_;
};

}  // namespace wetcurl
