// Learned strands out of what is attached to the head, on the CPU, a strand a lane.
#pragma once

#include <vector>

#include "learn/codec/head_shapes.h"
#include "learn/codec/strand_lanes.h"

namespace wetcurl {

class OutsideLanes {
  public:
    using S = Pack<float>;
    // edges (strand, particle): how long the edge to a particle is at rest [m]. Throws Error where depths are
    // not one a particle.
    OutsideLanes(HeadShapes head, const StrandLanes& lanes, int particles, const std::vector<float>& edges);

    // Moves a block's strands x (particles) in the world [m] out of the shapes and leads them around these;
    // roots stay.
    void push(int block, const Pose& head, Vec3<S>* x) const;

  private:
    HeadShapes head_;
    std::vector<ShapeView> views_;  // of its shapes
    int particles_;
    std::vector<S> depth_,
        torn_;  // (block, particle); torn_: squares of edges so long that they are torn [m^2]
};

}  // namespace wetcurl
