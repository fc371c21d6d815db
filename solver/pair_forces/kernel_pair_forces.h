// What compared methods that draw strands together share.
#pragma once

#include "solver/compared/akinci2013.h"
#include "solver/pair_forces/pair_forces.h"

namespace wetcurl {

// Forces between strands, part of which each pair's `strength` times a kernel K of its distance is: what
// methods of that kind share.
class KernelPairForces : public PairForces {
  public:
    KernelPairForces(const Scene& scene, double strength, double radius,
                     double (*kernel)(double r, double h));
    // Of the part by K.
    double potential(const std::vector<Vec3d>& x, double time) override;
    double neighbours_mean() const override { return pairs_.neighbours_mean(); }
    size_t bytes() const override;

  protected:
    const std::vector<double> mass_;  // (strand, particle) [kg]
    NeighbourPairs pairs_;

  private:
    const double strength_;  // [N m^3/kg^2]
    const akinci2013::KernelSum kernel_sum_;
};

}  // namespace wetcurl
