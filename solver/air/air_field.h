// The air that moves hair: velocities on a regular grid. Stam 1999 (Stable Fluids), the paper's scene 10; the
// staggered places are Harlow and Welch 1965; sources, the far wind and the drag back on the air are ours.
#pragma once

#include <array>
#include <vector>

#include "base/vec3.h"
#include "solver/air/poisson.h"
#include "solver/air/staggered.h"
#include "solver/terms/air.h"

namespace wetcurl {

// Of velocities that a run carries from frame to frame, by axis.
inline constexpr const char* air_component_names[] = {"air x", "air y", "air z"};

// A piece of hair as the air meets it: place [m], velocity [m/s], drag [kg/s].
struct DragPoint {
    Vec3f x, v;
    float drag;
};

class AirField {
  public:
    explicit AirField(const Air& air);

    // The air after dt [s], at `time` [s]: advection, diffusion, sources, the hair's brake, projection. It
    // makes no memory. Hair is empty unless two_way.
    void step(double dt, double time, const std::vector<DragPoint>& hair = {});

    Vec3d at(const Vec3d& x) const { return view().at(x); }          // [m/s]; the wind outside the box
    double divergence() const;                                       // max |div u| [1/s]
    double energy() const;                                           // [J] in the box
    double divergence_before() const { return divergence_before_; }  // of the last step's projection
    size_t bytes() const;

    // All that a step reads of the one before: components at the faces of each axis [m/s].
    const std::array<std::vector<double>, 3>& velocities() const { return u_; }
    void blow_as(int axis, const std::vector<double>& u) { u_[size_t(axis)] = u; }

    double cell() const { return cell_; }
    // The component along `axis` at its face (i, j, k), and that face's centre: a face lies at the lower side
    // of its cell, and there is one more of them than cells along the axis.
    double& face(int axis, int i, int j, int k) {
        return u_[size_t(axis)][size_t(view().index(axis, i, j, k))];
    }
    std::array<int, 3> faces(int axis) const {
        return {view().faces(axis, 0), view().faces(axis, 1), view().faces(axis, 2)};
    }
    Vec3d place(int axis, int i, int j, int k) const { return view().place(axis, i, j, k); }

    // The stages of a step.
    void advect(double dt);
    void diffuse(double dt);
    void blow(double time);
    void brake(const std::vector<DragPoint>& hair, double dt);
    void project();

  private:
    // Valid until the next stage.
    StaggeredGrid view() const;
    template <class F>
    void for_each_face(int axis, F f) const;
    void diffuse_along(int component, int axis, double a);

    const Air air_;
    const double cell_;
    std::array<std::vector<double>, 3> u_, next_;
    std::array<std::vector<double>, 3>
        braked_;                  // momentum that hair brings to each face; empty unless two_way
    std::vector<double> factor_;  // of the diffusion's rows along an axis
    PoissonBox poisson_;
    std::vector<double> pressure_;  // times dt over density
    double divergence_before_ = 0;
};

// Of a box: a cell's side [m], and its lower corner.
double cell_of(const Air& air);
Vec3d corner_of(const Air& air);

}  // namespace wetcurl
