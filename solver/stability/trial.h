// A scene under trial: its simulation, and its energy against the work done on it.
#pragma once

#include <memory>

#include "solver/chain/one_strand.h"
#include "solver/stability/battery.h"

namespace wetcurl {

// Of the scenes that the battery makes: strands of one shape each, in the groom's place.
struct StrandSetup {
    std::vector<Points> shapes = {};    // of equal numbers of particles
    double k_over_m = 1e5;              // [1/s²] of stretch, bend and core alike
    double dt = 1.0 / 240;              // [s], also the frame
    double limiter = 0;                 // allowed strain; 0: no limiter
    Vec3d gravity{0, -9.81, 0};         // [m/s²]
    double drag = 0;                    // [1/s], Eq 13; 0, or a method without it: no such term
    std::string more = {};              // TOML that is added: motion, solids, wet terms
    std::vector<std::string> set = {};  // key.path=value
    double fibre = 0;  // [m] diameter of a fibre in the place of springs, in ten substeps of dt; 0: springs
};
// key.path=value of a number, all digits kept.
std::string setting(const std::string& key, double value);
Scene scene_of(const StrandSetup& setup, const StabilityMethod& method);
// Text of a scene with the settings of `method`, of which those of terms that it does not name are left out.
Scene scene_of(const std::string& text, const std::string& name, const std::string& folder,
               std::vector<std::string> set, const StabilityMethod& method);

class Trial {
  public:
    Trial(const StabilityMethod& method, Scene scene);
    void advance();  // one frame, looked at
    void advance_for(double seconds);
    // Goes on in another scene of the same strands: other mass, step or terms. What the energy changes by is
    // given from outside.
    void go_on_in(Scene scene);
    // The state is changed by hand; energy is counted from here on.
    void set(const SimulationState& state);

    const Scene& scene() const { return *scene_; }
    Simulation& simulation() { return *simulation_; }
    double total() const;
    double weight_length() const;  // m g L of all strands [J]

    bool finite = true;
    double start, given = 0;                            // [J]
    double most_kinetic = 0, kinetic = 0, most_energy;  // [J]
    double excess = 0, scale = 0;                       // of E - E0 - W, and max(K + |W|) [J]
    double energy_ratio() const;
    void report(StabilityCase& result) const;  // finite, energy_ratio, precision

  private:
    void look();
    const StabilityMethod method_;
    std::unique_ptr<Scene> scene_;
    std::unique_ptr<Simulation> simulation_;
    bool promoted_ = false;  // to double, since single cannot be trusted with the scene
};

// The rms third difference of what is seen in the next eight frames, over a segment: once all should be
// still.
double jitter_of(Trial& trial);
// Largest distance of a particle in two states [m].
double farthest(const std::vector<Vec3d>& a, const std::vector<Vec3d>& b);
// After particles of strands of n were moved by hand: frames follow, and there is no history.
void carry_frames(SimulationState& s, int n);
// Of each coordinate up to `size` [m].
void add_noise(SimulationState& s, int n, double size, unsigned seed);
// Strands turned about their roots, more toward the tip: a large bend.
void sway(SimulationState& s, int n, double angle);

}  // namespace wetcurl
