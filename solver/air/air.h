// The air that moves hair: velocities on a regular grid. Stam 1999 (Stable Fluids), the paper's scene 10; the
// staggered places are Harlow and Welch 1965; sources, the far wind and the drag back on the air are ours.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "base/parameters.h"
#include "base/vec3.h"
#include "solver/air/multigrid.h"

namespace wetcurl {

// A ball in which the air is blown at a velocity.
struct AirSource {
    static constexpr const char* table = "air.source";
    double radius, period;
    Vec3d center{0, 0, 0}, velocity{0, 0, 1};  // [m], [m/s]
    static constexpr Parameter<AirSource> parameters[] = {
        {"radius", &AirSource::radius, "m", 0.08, 1e-4, 100,
         "of the ball; it blows less towards its surface"},
        {"period", &AirSource::period, "s", 0, 0, 1e4, "of gusts from none to full and back; 0: steady"},
    };
    // Share of the ball's velocity that the air at x takes on, in [0, 1].
    double share(const Vec3d& x, double time) const;
};

// What a scene says of its air. Outside the box it moves as `wind`.
struct Air {
    static constexpr const char *name = "air", *table = "air";
    double size, viscosity, density;
    std::array<int, 3> grid{64, 64, 64};   // cells, cubes, each way
    Vec3d center{0, 0, 0}, wind{0, 0, 0};  // [m], [m/s]
    bool two_way = false;                  // hair brakes the air
    std::vector<AirSource> sources;
    static constexpr Parameter<Air> parameters[] = {
        {"size", &Air::size, "m", 0.8, 1e-3, 1000, "the longest side of the box"},
        {"viscosity", &Air::viscosity, "m^2/s", 1.5e-5, 0, 10, "kinematic, nu of Stam 1999 (air at 20 C)"},
        {"density", &Air::density, "kg/m^3", 1.2, 1e-3, 1e4, "of the air that two_way brakes"},
    };
};

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

    Vec3d at(const Vec3d& x) const;                                  // [m/s]; the wind outside the box
    double divergence() const;                                       // max |div u| [1/s]
    double energy() const;                                           // [J] in the box
    double divergence_before() const { return divergence_before_; }  // of the last step's projection
    int cycles() const { return cycles_; }                           // V-cycles that it took
    size_t bytes() const;

    double cell() const { return cell_; }
    // The component along `axis` at its face (i, j, k), and that face's centre: a face lies at the lower side
    // of its cell, and there is one more of them than cells along the axis.
    double& face(int axis, int i, int j, int k) { return u_[size_t(axis)].at(i, j, k); }
    std::array<int, 3> faces(int axis) const { return u_[size_t(axis)].n; }
    Vec3d place(int axis, int i, int j, int k) const;

    // The stages of a step.
    void advect(double dt);
    void diffuse(double dt);
    void blow(double time);
    void brake(const std::vector<DragPoint>& hair, double dt);
    void project();

  private:
    struct Component {
        std::array<int, 3> n;
        std::vector<double> v;  // x fastest
        size_t index(int i, int j, int k) const {
            return (size_t(k) * size_t(n[1]) + size_t(j)) * size_t(n[0]) + size_t(i);
        }
        double& at(int i, int j, int k) { return v[index(i, j, k)]; }
        double at(int i, int j, int k) const { return v[index(i, j, k)]; }
    };
    // Eight faces around a place and their weights.
    struct Stencil {
        size_t corner, step[3];
        double t[3];
    };
    Vec3d in_cells(const Vec3d& x) const { return (1 / cell_) * (x - corner_); }
    bool inside(const Vec3d& cells) const;
    Stencil stencil(int axis, const Vec3d& cells) const;
    double sample(int axis, const Vec3d& cells) const;
    Vec3d velocity(const Vec3d& cells) const;
    double divergence(int i, int j, int k) const;
    void diffuse_lines(Component& u, int axis, double a);

    const Air air_;
    const double cell_;
    const Vec3d corner_;
    Component u_[3], next_[3];
    std::vector<double> braked_[3];  // momentum that hair brings to each face; empty unless two_way
    std::vector<double> factor_;     // of the diffusion's rows along an axis
    Multigrid pressure_;             // times dt over density; kept as the next step's first guess
    double divergence_before_ = 0;
    int cycles_ = 0;
};

}  // namespace wetcurl
